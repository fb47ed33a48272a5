// Design lean18: the setup unit's program. Generated, not to be edited:
// `cargo run -p splatline-rtl --example rtl -- package`
package splatline_setup_pkg;

  localparam int POSITION = 30;  // magnitude bits of a difference to the eye
  localparam int LOW = 0;  // those of its low part
  localparam int FAINT = 19;  // those of a position that are below its centre's rounding; 0: it comes in two words
  localparam int MANTISSA = 18;  // magnitude bits of a mantissa
  localparam int AXIS_DROP = 7;  // bits of an axis' components that are 0
  localparam int TURNED = 1;  // do axes come turned?
  localparam int ROUND = 135;  // cycles of a round
  localparam int LATENCY = 22;  // cycles from a sum's last slot to its use
  localparam int LOAD_AHEAD = 48;  // cycles before a round's end from which its records are full
  localparam int OUT_ROUND = 7;  // round in which a splat's results come
  localparam int OUT_LAST = 125;  // the last slot with one of them
  localparam int FIRST_REGISTER = 64;  // address of the first number outside the cores
  localparam int EYE_X = 64;
  localparam int EYE_Y = 65;
  localparam int EYE_Z = 66;
  localparam int FLAGS = 67;
  localparam int NEAR = 68;
  localparam int FAR = 69;
  localparam int AXIS_XX = 70;
  localparam int AXIS_XY = 71;
  localparam int AXIS_XZ = 72;
  localparam int AXIS_YX = 73;
  localparam int AXIS_YY = 74;
  localparam int AXIS_YZ = 75;
  localparam int AXIS_ZX = 76;
  localparam int AXIS_ZY = 77;
  localparam int AXIS_ZZ = 78;
  localparam int SLOT_BITS = 108;

  // One issue slot of a core: a term of a sum. What the fields mean stands in setup_core.sv.
  typedef struct packed {
    logic [3:0] round;  // rounds since the splat's first
    logic a_input;  // first factor: an item of the record,
    logic a_constant;  // the constant,
    logic [7:0] a;  // or this register,
    logic [3:0] a_turn;  // of which splats have several in turn: a mask
    logic b_constant;  // second factor: the constant,
    logic [7:0] b;  // or this register
    logic [3:0] b_turn;
    logic [5:0] constant;
    logic [1:0] lookup;  // 1: reciprocal, 2: root, 3: logarithm
    logic entry;  // the table's entry, not its step times the rest
    logic power;  // the first factor's leading bit's place, not the factor
    logic plain;  // the first factor, not the product
    logic signed [7:0] offset;  // added to the factors' exponents
    logic [1:0] pick;  // not the first factor but the constant where it is negative (1) or is not (2), otherwise the second
    logic by_flag;  // where the flag is not set, the constant is the first factor; beside one as second factor
    logic [1:0] flag;  // the term is the second register, to 31 bits
    logic negated;  // negated before it is aligned
    logic subtracted;  // negated after it is aligned
    logic down;  // rounded down
    logic first;
    logic again;  // from here on in a coarser unit
    logic last;
    logic [1:0] base;  // 0: the largest that a term asks for, 1: the first term's, 2: step alone
    logic signed [6:0] step;  // what is asked for, from the exponent on
    logic addend;  // a constant is added,
    logic [5:0] start;  // this one
    logic normal;  // rounded to a mantissa
    logic [4:0] drop;  // of 31 - drop bits; otherwise left as it is,
    logic [5:0] spare;  // moved left by so much,
    logic extended;  // with what is above it in the exponent's place, and a bit for what is below it
    logic write;
    logic [7:0] place;  // register of the result
    logic [3:0] place_turn;
    logic out;  // what stands at the second factor's register leaves the core and is no factor,
    logic [3:0] word;  // as this word
  } slot_t;

  // A splat as setup takes it: `VolumeSplat` with exponents of 10 bits, as the packet has them.
  typedef struct packed {
    logic [31:0] blue;  // UQ4.28
    logic [31:0] green;
    logic [31:0] red;
    logic signed [9:0] weight_exponent;
    logic signed [31:0] weight;
    logic [29:0] axis_exponents;  // the first axis' are the lowest bits
    logic [287:0] axes;  // x, y, z of the first axis, then of the others
    logic [29:0] centre_exponents;
    logic [95:0] centre;
  } record_t;

  // What the cores get of it: the difference to the eye in two parts, the axes, the weight; see setup_difference.sv.
  localparam int ITEM_BITS = 44;  // {exponent 12, value 32}
  localparam int BEAT_BITS = 88;  // two of them
  localparam int PAIR_BITS = 102;  // two words of a splat, which are results with their exponents
  localparam logic DIRECTS = 1'b0;  // Does the program give directions? Their words leave beside, without exponents.
  localparam int WORD_BITS = PAIR_BITS + (DIRECTS ? 33 : 0);

  // What all cores obey in a cycle and what comes and goes beside it: one group of cores hands it to the
  // next (setup_group.sv). What the fields mean stands in setup_core.sv and setup_memory.sv.
  typedef struct packed {
    logic [22*SLOT_BITS-1:0] slots;  // slot i was issued i cycles ago
    logic unread_a;
    logic unread_b;
    logic [7:0] a_place;
    logic [7:0] b_place;
    logic write;
    logic [7:0] write_place;
    logic [50:0] constant1;
    logic [32:0] picked3;
    logic [17:0] offset3;
    logic [32:0] right4;
    logic [63:0] start14;
    logic [15:0] half19;
    logic [16:0] mask19;
    logic side;  // of the records that are read,
    logic out_side;  // of the results that `out` slots write
    logic load;  // a beat of a record comes
    logic [5:0] load_core;  // to this core, counted from the group's first,
    logic [3:0] load_place;
    logic [BEAT_BITS-1:0] load_beat;
    logic [5:0] drain_core;  // whose results go,
    logic [3:0] drain_place;  // this one
  } step_t;

  // The slot that is issued in each cycle of a round.
  function automatic logic [107:0] microcode(input logic [7:0] cycle);
    case (cycle)
      8'd0: microcode = 108'h804200e300000220004b010411;  // z; out: z, high
      8'd1: microcode = 108'h80c210e380000020004b010410;  // z; out: z, low
      8'd2: microcode = 108'h814230e4000000a0004b030412;  // z; out: position u
      8'd3: microcode = 108'h400040e4878400a7c0000200f4;  // z, high; out: position v
      8'd4: microcode = 108'h400070e4878400a7c0010210fa;  // z, low; out: 1/yy
      8'd5: microcode = 108'h82008060078402a7c05b02c837;  // axis 1, row 1; out: horizontal
      8'd6: microcode = 108'h81808860078402a7c05b02c438;  // axis 1, row 0; out: squared_width
      8'd7: microcode = 108'h8042906180000220004b010219;  // y; out: shear
      8'd8: microcode = 108'h80c2a06200000020004b01021c;  // y; out: conic c
      8'd9: microcode = 108'h81429862800000a0004b03021b;  // y; out: cross
      8'd10: microcode = 108'h8100b060078402a7c05b02c03d;  // axis 0, row 2; out: peak
      8'd11: microcode = 108'h80016600078402a7c05b02b833;  // axis 0, row 0; out: cut-off
      8'd12: microcode = 108'h8042000000000220004b010000;  // x
      8'd13: microcode = 108'h80c2000080000020004b010000;  // x
      8'd14: microcode = 108'h81420001000000a0004b030000;  // x
      8'd15: microcode = 108'h83800000078402a7c05b02d420;  // axis 2, row 1
      8'd16: microcode = 108'h83000000078402a7c05b02d020;  // axis 2, row 0
      8'd17: microcode = 108'h80800000078402a7c05b02bc20;  // axis 0, row 1
      8'd18: microcode = 108'h82800000078402a7c05b02cc20;  // axis 1, row 2
      8'd19: microcode = 108'h83400000078402a7c05b02d820;  // axis 2, row 2
      8'd20: microcode = 108'h83c00000078402a7c0010220e0;  // weight
      8'd21: microcode = 108'h121c10c09040102a7c001031200;  // ratio u, from below
      8'd22: microcode = 108'h122c0dc2b040102a7c001031a00;  // ratio v, from below
      8'd23: microcode = 108'h31e054800000002a0005b02f420;  // density squared
      8'd24: microcode = 108'h2080000536988227c001010600;  // 1/z or 1, seed
      8'd25: microcode = 108'h2080000522bc90a7c001030600;  // 1/z or 1, seed
      8'd26: microcode = 108'h20a1c000007840609005b013800;  // trace
      8'd27: microcode = 108'h226c0000007840489005b033800;  // trace
      8'd28: microcode = 108'h1041d5200000002a0005b02a860;  // weight of the area
      8'd29: microcode = 108'h429400000078402204041014e00;  // 1/density
      8'd30: microcode = 108'h429414c00000000a04041034e00;  // 1/density
      8'd31: microcode = 108'h226c0000007840609005b0060e0;  // yy
      8'd32: microcode = 108'h24000000c07840489005b0260e0;  // yy
      8'd33: microcode = 108'h51f86000e00000ad8ad81035600;  // 1/4 - d/5
      8'd34: microcode = 108'h6160c0000778002562f80a95e00;  // cut-off, unlimited
      8'd35: microcode = 108'h6160e0010087c00560000a95e00;  // cut-off, unlimited
      8'd36: microcode = 108'h6160e0010887c00560000a95e00;  // cut-off, unlimited
      8'd37: microcode = 108'h61f840000078400560000a95e00;  // cut-off, unlimited
      8'd38: microcode = 108'h61f855c00000008d60000ab5e00;  // cut-off, unlimited
      8'd39: microcode = 108'h640000004878400d60000036000;  // above 0
      8'd40: microcode = 108'h640000011078408d60000036200;  // beyond the end
      8'd41: microcode = 108'h72d0050e0000002a0005f036a00;  // extent squared u
      8'd42: microcode = 108'h72d0060e0000002a0005f036e00;  // extent squared v
      8'd43: microcode = 108'h122011209840102a7c05b031400;  // ratio u, from above
      8'd44: microcode = 108'h123011a0b840102a7c05b031c00;  // ratio v, from above
      8'd45: microcode = 108'h31e84000057640227c04100f820;  // density, seed
      8'd46: microcode = 108'h31e840000438000a7c04102f820;  // density, seed
      8'd47: microcode = 108'h20810605000092d46581030800;  // 1/z or 1, defect
      8'd48: microcode = 108'h121820006800002d826006e30e0;  // position u
      8'd49: microcode = 108'h227413a0000000609005b00ec20;  // determinant
      8'd50: microcode = 108'h227813c0000000409005b00ec20;  // determinant
      8'd51: microcode = 108'h227c13e0000000409005b00ec20;  // determinant
      8'd52: microcode = 108'h22702000c00000489005b02ec20;  // determinant
      8'd53: microcode = 108'h41f04000007840629405b015000;  // density, twice
      8'd54: microcode = 108'h41e854e00000004a9405b035000;  // density, twice
      8'd55: microcode = 108'h51f85560000000ad8ae81035800;  // 1/3 - d (1/4 ..)
      8'd56: microcode = 108'h22401240000000609005b00e820;  // xy
      8'd57: microcode = 108'h225012c0000000409005b00e820;  // xy
      8'd58: microcode = 108'h22601340000000489005b02e820;  // xy
      8'd59: microcode = 108'h20c1c000036980227c001014000;  // 1/yy, seed
      8'd60: microcode = 108'h20c1c000022bc10a7c001034000;  // 1/yy, seed
      8'd61: microcode = 108'h62c015e04840102a7c001036400;  // cut-off above 0
      8'd62: microcode = 108'h30c1d4800000002a0005b028060;  // horizontal
      8'd63: microcode = 108'h72d40000057640227c05f016c00;  // extent u
      8'd64: microcode = 108'h72d400000438000a7c05f036c00;  // extent u
      8'd65: microcode = 108'h11704000007840609005b011e00;  // sheared 0 u
      8'd66: microcode = 108'h12280c02000001489005b031e00;  // sheared 0 u
      8'd67: microcode = 108'h11904000007840609005b012a00;  // sheared 1 v
      8'd68: microcode = 108'h12380cc2000001489005b032a00;  // sheared 1 v
      8'd69: microcode = 108'h20c0000007840220404b010a00;  // 1/z or 1
      8'd70: microcode = 108'h20c10800000000a0404b030a00;  // 1/z or 1
      8'd71: microcode = 108'h11a84000007840609005b013200;  // sheared 2 v
      8'd72: microcode = 108'h12380d82000001489005b033200;  // sheared 2 v
      8'd73: microcode = 108'h11784000007840609005b012200;  // sheared 0 v
      8'd74: microcode = 108'h12380c02000001489005b032200;  // sheared 0 v
      8'd75: microcode = 108'h11a04000007840609005b012e00;  // sheared 2 u
      8'd76: microcode = 108'h12280d82000001489005b032e00;  // sheared 2 u
      8'd77: microcode = 108'h11884000007840609005b012600;  // sheared 1 u
      8'd78: microcode = 108'h12280cc2000001489005b032600;  // sheared 1 u
      8'd79: microcode = 108'h14000000507840609005b00f020;  // slant
      8'd80: microcode = 108'h12281140000000409005b00f020;  // slant
      8'd81: microcode = 108'h123811c0000000489005b02f020;  // slant
      8'd82: microcode = 108'h21d84000036980227c001014400;  // 1/determinant, seed
      8'd83: microcode = 108'h21d84000022bc10a7c001034400;  // 1/determinant, seed
      8'd84: microcode = 108'h31f04000036980227c001014a00;  // 1/density, seed
      8'd85: microcode = 108'h31f04000022bc10a7c001034a00;  // 1/density, seed
      8'd86: microcode = 108'h4150d5000000002a0005b035400;  // peak of the profile
      8'd87: microcode = 108'h51f85580000000ad8af01035a00;  // 1/2 - d (1/3 ..)
      8'd88: microcode = 108'h123c0e020000002a0005b032000;  // column 0 u
      8'd89: microcode = 108'h20c1d4000000012d46581034200;  // 1/yy, defect
      8'd90: microcode = 108'h12540e420000002a0005b032c00;  // column 1 v
      8'd91: microcode = 108'h62c416411840202a7c001036600;  // cut-off
      8'd92: microcode = 108'h20410a00000002a0004b02dc20;  // on plane v
      8'd93: microcode = 108'h20010a00000002a0004b030c00;  // on plane u
      8'd94: microcode = 108'h21436c07800002a0005b02e435;  // gain v; out: extent u
      8'd95: microcode = 108'h21420006800002a0005b02e020;  // gain u
      8'd96: microcode = 108'h12440e420000002a0005b032400;  // column 0 v
      8'd97: microcode = 108'h12640e420000002a0005b033400;  // column 2 v
      8'd98: microcode = 108'h125c0e020000002a0005b033000;  // column 2 u
      8'd99: microcode = 108'h11b860007800002d827006e40e0;  // position v
      8'd100: microcode = 108'h124c0e020000002a0005b032800;  // column 1 u
      8'd101: microcode = 108'h72dc0000057640227c05f017000;  // extent v
      8'd102: microcode = 108'h72dc00000438000a7c05f037000;  // extent v
      8'd103: microcode = 108'h31d8470e0000002a0005b028860;  // squared_width
      8'd104: microcode = 108'h31d0470e0000002a0005b029060;  // shear
      8'd105: microcode = 108'h21d854400000012d46581034600;  // 1/determinant, defect
      8'd106: microcode = 108'h30a1d4800000002a0005b02a060;  // conic c
      8'd107: microcode = 108'h31f054a00000012d46581034c00;  // 1/density, defect
      8'd108: microcode = 108'h42a8220ec8000a2a0005b02b060;  // peak
      8'd109: microcode = 108'h51f855a00000002d70001035c00;  // d (1/2 ..)
      8'd110: microcode = 108'h31d054800000002a0005b029860;  // cross
      8'd111: microcode = 108'h22800000007840220405b0070e0;  // 1/yy
      8'd112: microcode = 108'h228014200000000a0405b0270e0;  // 1/yy
      8'd113: microcode = 108'h62cc00000078802a7c05f036800;  // cut-off, 16 bits
      8'd114: microcode = 108'h1b84000007840ad82a80031800;  // below the largest ratio v
      8'd115: microcode = 108'h21800000078402d82800030e00;  // above the least ratio u
      8'd116: microcode = 108'h2180000007840ad82880031000;  // below the largest ratio u
      8'd117: microcode = 108'h1b840000078402d82a00031600;  // above the least ratio v
      8'd118: microcode = 108'h1c04e420000002a0005b035200;  // area
      8'd119: microcode = 108'h12481240000000609005b013600;  // yy, sharp
      8'd120: microcode = 108'h125812c0000000409005b013600;  // yy, sharp
      8'd121: microcode = 108'h12681340000000489005b033600;  // yy, sharp
      8'd122: microcode = 108'h12401200000000609005b0050e0;  // xx
      8'd123: microcode = 108'h12501280000000409005b0050e0;  // xx
      8'd124: microcode = 108'h12601300000000409005b0050e0;  // xx
      8'd125: microcode = 108'h14001700c07840489005b0250f6;  // xx; out: extent v
      8'd126: microcode = 108'h124012c0000000609005b013a00;  // minor 0 1
      8'd127: microcode = 108'h12481280000001489005b033a00;  // minor 0 1
      8'd128: microcode = 108'h12401340000000609005b013c00;  // minor 0 2
      8'd129: microcode = 108'h12481300000001489005b033c00;  // minor 0 2
      8'd130: microcode = 108'h12501340000000609005b013e00;  // minor 1 2
      8'd131: microcode = 108'h12581300000001489005b033e00;  // minor 1 2
      8'd132: microcode = 108'h22880000007840220405b014800;  // 1/determinant
      8'd133: microcode = 108'h228814600000000a0405b034800;  // 1/determinant
      8'd134: microcode = 108'h4160c000063c402d72d0102fc20;  // rest
      default: microcode = 108'h0;
    endcase
  endfunction

endpackage
