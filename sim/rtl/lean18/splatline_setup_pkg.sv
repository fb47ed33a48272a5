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
  localparam int LATENCY = 24;  // cycles from a sum's last slot to its use
  localparam int LOAD_AHEAD = 48;  // cycles before a round's end from which its records are full
  localparam int OUT_ROUND = 9;  // round in which a splat's results come
  localparam int OUT_LAST = 13;  // the last slot with one of them
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

  // What all cores obey in a cycle and what comes and goes beside it: one pair of cores hands it to the next
  // (setup_pair.sv). What the fields mean stands in setup_core.sv and setup_memory.sv.
  typedef struct packed {
    logic [24*SLOT_BITS-1:0] slots;  // slot i was issued i cycles ago
    logic unread_a;
    logic unread_b;
    logic [7:0] a_place;
    logic [7:0] b_place;
    logic write;
    logic [7:0] write_place;
    logic [50:0] constant1;
    logic [32:0] picked3;
    logic [50:0] right3;
    logic [63:0] start17;
    logic [15:0] half21;
    logic [16:0] mask21;
    logic side;  // of the records that are read,
    logic out_side;  // of the results that `out` slots write
    logic load;  // a beat of a record comes
    logic [5:0] load_core;  // to this core, counted from the pair's first,
    logic [3:0] load_place;
    logic [BEAT_BITS-1:0] load_beat;
    logic [5:0] drain_core;  // whose results go,
    logic [3:0] drain_place;  // this one
  } step_t;

  // The slot that is issued in each cycle of a round.
  function automatic logic [107:0] microcode(input logic [7:0] cycle);
    case (cycle)
      8'd0: microcode = 108'h800201e300000220004b015811;  // z; out: z, high
      8'd1: microcode = 108'h804221e380000020004b015810;  // z; out: z, low
      8'd2: microcode = 108'h808250e4000000a0004b035812;  // z; out: position u
      8'd3: microcode = 108'h400060e4878400a7c0000201f4;  // z, high; out: position v
      8'd4: microcode = 108'h4000e0e4878400a7c0010221fc;  // z, low; out: conic c
      8'd5: microcode = 108'h8002a0e000000220004b015417;  // x; out: horizontal
      8'd6: microcode = 108'h804290e080000020004b01541a;  // x; out: 1/yy
      8'd7: microcode = 108'h8082b0e1000000a0004b035418;  // x; out: squared_width
      8'd8: microcode = 108'h8002c0e180000220004b015619;  // y; out: shear
      8'd9: microcode = 108'h8042d0e200000020004b01561b;  // y; out: cross
      8'd10: microcode = 108'h80830862800000a0004b03561d;  // y; out: peak
      8'd11: microcode = 108'h83415020078402a7c05b032c33;  // axis 2, row 1; out: cut-off
      8'd12: microcode = 108'h8301be00078402a7c05b032835;  // axis 2, row 0; out: extent u
      8'd13: microcode = 108'h8201c200078402a7c05b031836;  // axis 0, row 2; out: extent v
      8'd14: microcode = 108'h82c00000078402a7c05b032420;  // axis 1, row 2
      8'd15: microcode = 108'h82800000078402a7c05b032020;  // axis 1, row 1
      8'd16: microcode = 108'h82400000078402a7c05b031c20;  // axis 1, row 0
      8'd17: microcode = 108'h81800000078402a7c05b031020;  // axis 0, row 0
      8'd18: microcode = 108'h81c00000078402a7c05b031420;  // axis 0, row 1
      8'd19: microcode = 108'h83800000078402a7c05b033020;  // axis 2, row 2
      8'd20: microcode = 108'h83c00000078402a7c0010240e0;  // weight
      8'd21: microcode = 108'h12dc1620b040102a7c001037200;  // ratio v, from below
      8'd22: microcode = 108'h12cc16009040102a7c001036a00;  // ratio u, from below
      8'd23: microcode = 108'h230018c0000000609005b019600;  // minor 1 2
      8'd24: microcode = 108'h23081880000001489005b039600;  // minor 1 2
      8'd25: microcode = 108'h327059a00000012d46581039c00;  // 1/determinant, defect
      8'd26: microcode = 108'h2b00000536988227c001015a00;  // 1/z or 1, seed
      8'd27: microcode = 108'h2b00000522bc90a7c001035a00;  // 1/z or 1, seed
      8'd28: microcode = 108'h22f01780000000609005b0070e0;  // xx
      8'd29: microcode = 108'h23001800000000409005b0070e0;  // xx
      8'd30: microcode = 108'h23101880000000409005b0070e0;  // xx
      8'd31: microcode = 108'h24000000c07840489005b0270e0;  // xx
      8'd32: microcode = 108'h42904000036980227c001019e00;  // 1/density, seed
      8'd33: microcode = 108'h42904000022bc10a7c001039e00;  // 1/density, seed
      8'd34: microcode = 108'h126856400000002a0005b03a600;  // area
      8'd35: microcode = 108'h5200da400000002a0005b03a800;  // peak of the profile
      8'd36: microcode = 108'h62985aa0000000ad8ae8103ac00;  // 1/3 - d (1/4 ..)
      8'd37: microcode = 108'h7210c0000778002562f80a9b200;  // cut-off, unlimited
      8'd38: microcode = 108'h7210e0010087c00560000a9b200;  // cut-off, unlimited
      8'd39: microcode = 108'h7210e0010887c00560000a9b200;  // cut-off, unlimited
      8'd40: microcode = 108'h729840000078400560000a9b200;  // cut-off, unlimited
      8'd41: microcode = 108'h72985b000000008d60000abb200;  // cut-off, unlimited
      8'd42: microcode = 108'h740000004878400d6000003b400;  // above 0
      8'd43: microcode = 108'h740000011078408d6000003b600;  // beyond the end
      8'd44: microcode = 108'h3101d3c20000012d46581039800;  // 1/yy, defect
      8'd45: microcode = 108'h12e01720b840102a7c05b037400;  // ratio v, from above
      8'd46: microcode = 108'h12d016a09840102a7c05b036c00;  // ratio u, from above
      8'd47: microcode = 108'h231c0000007840609005b0080e0;  // yy
      8'd48: microcode = 108'h24000000c07840489005b0280e0;  // yy
      8'd49: microcode = 108'h33340000007840220405b014020;  // 1/determinant
      8'd50: microcode = 108'h333419c00000000a0405b034020;  // 1/determinant
      8'd51: microcode = 108'h2b015a05000092d46581035c00;  // 1/z or 1, defect
      8'd52: microcode = 108'h12c020006800002d826006e50e0;  // position u
      8'd53: microcode = 108'h8374080e0000002a0005f03c000;  // extent squared v
      8'd54: microcode = 108'h8374070e0000002a0005f03bc00;  // extent squared u
      8'd55: microcode = 108'h20e1c000007840609005b019000;  // trace
      8'd56: microcode = 108'h231c0000007840489005b039000;  // trace
      8'd57: microcode = 108'h429059e00000012d4658103a000;  // 1/density, defect
      8'd58: microcode = 108'h1081da600000002a0005b030060;  // weight of the area
      8'd59: microcode = 108'h5350240ec8000a2a0005b030860;  // peak
      8'd60: microcode = 108'h62985ac0000000ad8af0103ae00;  // 1/2 - d (1/3 ..)
      8'd61: microcode = 108'h12c420007800002d827006e60e0;  // position v
      8'd62: microcode = 108'h4270490e0000002a0005b02b0e0;  // squared_width
      8'd63: microcode = 108'h22f017c0000000609005b00f060;  // xy
      8'd64: microcode = 108'h23001840000000409005b00f060;  // xy
      8'd65: microcode = 108'h231018c0000000489005b02f060;  // xy
      8'd66: microcode = 108'h73681b204840102a7c00103b800;  // cut-off above 0
      8'd67: microcode = 108'h41e0c90e0000002a0005b02c0e0;  // shear
      8'd68: microcode = 108'h41e0d4020000002a0005b02d0e0;  // cross
      8'd69: microcode = 108'h12284000007840609005b017a00;  // sheared 0 v
      8'd70: microcode = 108'h12e81182000001489005b037a00;  // sheared 0 v
      8'd71: microcode = 108'h12584000007840609005b018a00;  // sheared 2 v
      8'd72: microcode = 108'h12e81302000001489005b038a00;  // sheared 2 v
      8'd73: microcode = 108'h12404000007840609005b018200;  // sheared 1 v
      8'd74: microcode = 108'h12e81242000001489005b038200;  // sheared 1 v
      8'd75: microcode = 108'h2b40000007840220404b015e00;  // 1/z or 1
      8'd76: microcode = 108'h2b415c00000000a0404b035e00;  // 1/z or 1
      8'd77: microcode = 108'h12504000007840609005b018600;  // sheared 2 u
      8'd78: microcode = 108'h12d81302000001489005b038600;  // sheared 2 u
      8'd79: microcode = 108'h12384000007840609005b017e00;  // sheared 1 u
      8'd80: microcode = 108'h12d81242000001489005b037e00;  // sheared 1 u
      8'd81: microcode = 108'h12204000007840609005b017600;  // sheared 0 u
      8'd82: microcode = 108'h12d81182000001489005b037600;  // sheared 0 u
      8'd83: microcode = 108'h23241920000000609005b013820;  // determinant
      8'd84: microcode = 108'h23281940000000409005b013820;  // determinant
      8'd85: microcode = 108'h232c1960000000409005b013820;  // determinant
      8'd86: microcode = 108'h23202000c00000489005b033820;  // determinant
      8'd87: microcode = 108'h14000000507840609005b00f860;  // slant
      8'd88: microcode = 108'h12d816c0000000409005b00f860;  // slant
      8'd89: microcode = 108'h12e81740000000489005b02f860;  // slant
      8'd90: microcode = 108'h31f0d4020000002a0005b034420;  // density squared
      8'd91: microcode = 108'h433c0000007840220404101a200;  // 1/density
      8'd92: microcode = 108'h433c1a000000000a0404103a200;  // 1/density
      8'd93: microcode = 108'h5210c000063c402d72d01034c20;  // rest
      8'd94: microcode = 108'h12f416400000002a0005b037c00;  // column 0 v
      8'd95: microcode = 108'h62985ae00000002d7000103b000;  // d (1/2 ..)
      8'd96: microcode = 108'h131416400000002a0005b038c00;  // column 2 v
      8'd97: microcode = 108'h736c1b811840202a7c001035020;  // cut-off
      8'd98: microcode = 108'h130416400000002a0005b038400;  // column 1 v
      8'd99: microcode = 108'h30e1d4020000002a0005b02e0e0;  // conic c
      8'd100: microcode = 108'h2ac15e00000002a0004b036200;  // on plane v
      8'd101: microcode = 108'h2a815e00000002a0004b036000;  // on plane u
      8'd102: microcode = 108'h2bc20007800002a0005b036400;  // gain v
      8'd103: microcode = 108'h2bc20006800002a0005b033420;  // gain u
      8'd104: microcode = 108'h12fc13420000002a0005b038000;  // column 1 u
      8'd105: microcode = 108'h130c13420000002a0005b038800;  // column 2 u
      8'd106: microcode = 108'h12ec13420000002a0005b037800;  // column 0 u
      8'd107: microcode = 108'h2101c000036980227c001013c20;  // 1/yy, seed
      8'd108: microcode = 108'h2101c000022bc10a7c001033c20;  // 1/yy, seed
      8'd109: microcode = 108'h3101d4020000002a0005b02a0e0;  // horizontal
      8'd110: microcode = 108'h22704000036980227c001019a00;  // 1/determinant, seed
      8'd111: microcode = 108'h22704000022bc10a7c001039a00;  // 1/determinant, seed
      8'd112: microcode = 108'h32784000007840220405b0090e0;  // 1/yy
      8'd113: microcode = 108'h327859800000000a0405b0290e0;  // 1/yy
      8'd114: microcode = 108'h32884000057640227c041014820;  // density, seed
      8'd115: microcode = 108'h328840000438000a7c041034820;  // density, seed
      8'd116: microcode = 108'h42904000007840629405b01a400;  // density, twice
      8'd117: microcode = 108'h42885a200000004a9405b03a400;  // density, twice
      8'd118: microcode = 108'h52986000e00000ad8ad8103aa00;  // 1/4 - d/5
      8'd119: microcode = 108'h83780000057640227c05f01be00;  // extent u
      8'd120: microcode = 108'h837800000438000a7c05f03be00;  // extent u
      8'd121: microcode = 108'h72a040000078802a7c05f03ba00;  // cut-off, 16 bits
      8'd122: microcode = 108'h83800000057640227c05f01c200;  // extent v
      8'd123: microcode = 108'h838000000438000a7c05f03c200;  // extent v
      8'd124: microcode = 108'h2c400000078402d82a00036e00;  // above the least ratio v
      8'd125: microcode = 108'h2c00000007840ad82880036800;  // below the largest ratio u
      8'd126: microcode = 108'h2c000000078402d82800036600;  // above the least ratio u
      8'd127: microcode = 108'h2c40000007840ad82a80037000;  // below the largest ratio v
      8'd128: microcode = 108'h12f817c0000000609005b018e00;  // yy, sharp
      8'd129: microcode = 108'h13081840000000409005b018e00;  // yy, sharp
      8'd130: microcode = 108'h131818c0000000489005b038e00;  // yy, sharp
      8'd131: microcode = 108'h12f01840000000609005b019200;  // minor 0 1
      8'd132: microcode = 108'h12f81800000001489005b039200;  // minor 0 1
      8'd133: microcode = 108'h12f018c0000000609005b019400;  // minor 0 2
      8'd134: microcode = 108'h12f81880000001489005b039400;  // minor 0 2
      default: microcode = 108'h0;
    endcase
  endfunction

endpackage
