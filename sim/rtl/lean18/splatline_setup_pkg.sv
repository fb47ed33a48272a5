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
  localparam int LATENCY = 25;  // cycles from a sum's last slot to its use
  localparam int LOAD_AHEAD = 48;  // cycles before a round's end from which its records are full
  localparam int OUT_ROUND = 8;  // round in which a splat's results come
  localparam int OUT_LAST = 82;  // the last slot with one of them
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
    logic [25*SLOT_BITS-1:0] slots;  // slot i was issued i cycles ago
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
    logic [15:0] half22;
    logic [16:0] mask22;
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
      8'd0: microcode = 108'h804200e300000220004b012011;  // z; out: z, high
      8'd1: microcode = 108'h80c210e380000020004b012010;  // z; out: z, low
      8'd2: microcode = 108'h814240e4000000a0004b032014;  // z; out: position v
      8'd3: microcode = 108'h400030e4878400a7c0000200f2;  // z, high; out: position u
      8'd4: microcode = 108'h400070e4878400a7c0010210fa;  // z, low; out: 1/yy
      8'd5: microcode = 108'h8200a0e0078402a7c05b02e83b;  // axis 1, row 1; out: cross
      8'd6: microcode = 108'h838080e0078402a7c05b02f438;  // axis 2, row 1; out: squared_width
      8'd7: microcode = 108'h834090e0078402a7c05b02f839;  // axis 2, row 2; out: shear
      8'd8: microcode = 108'h8042b0e000000220004b011c1c;  // x; out: conic c
      8'd9: microcode = 108'h80c2c06080000020004b011c17;  // x; out: horizontal
      8'd10: microcode = 108'h8142d061000000a0004b031c1d;  // x; out: peak
      8'd11: microcode = 108'h8043840180000220004b011e13;  // y; out: cut-off
      8'd12: microcode = 108'h80c2000200000020004b011e00;  // y
      8'd13: microcode = 108'h81420002800000a0004b031e00;  // y
      8'd14: microcode = 108'h81800000078402a7c05b02e420;  // axis 1, row 0
      8'd15: microcode = 108'h82800000078402a7c05b02ec20;  // axis 1, row 2
      8'd16: microcode = 108'h83000000078402a7c05b02f020;  // axis 2, row 0
      8'd17: microcode = 108'h80000000078402a7c05b02d820;  // axis 0, row 0
      8'd18: microcode = 108'h80800000078402a7c05b02dc20;  // axis 0, row 1
      8'd19: microcode = 108'h81000000078402a7c05b02e020;  // axis 0, row 2
      8'd20: microcode = 108'h83c00000078402a7c0010220e0;  // weight
      8'd21: microcode = 108'h126812a0b040102a7c001033800;  // ratio v, from below
      8'd22: microcode = 108'h321056200000012d46581036400;  // 1/determinant, defect
      8'd23: microcode = 108'h125812809040102a7c001033000;  // ratio u, from below
      8'd24: microcode = 108'h227c14a0000000609005b015800;  // minor 0 1
      8'd25: microcode = 108'h22841460000001489005b035800;  // minor 0 1
      8'd26: microcode = 108'h42cc16800000012d46581036a00;  // 1/density, defect
      8'd27: microcode = 108'h2400000536988227c001012200;  // 1/z or 1, seed
      8'd28: microcode = 108'h2400000522bc90a7c001032200;  // 1/z or 1, seed
      8'd29: microcode = 108'h227c1520000000609005b015a00;  // minor 0 2
      8'd30: microcode = 108'h228414e0000001489005b035a00;  // minor 0 2
      8'd31: microcode = 108'h22841420000000609005b015400;  // yy, sharp
      8'd32: microcode = 108'h229414a0000000409005b015400;  // yy, sharp
      8'd33: microcode = 108'h22a41520000000489005b035400;  // yy, sharp
      8'd34: microcode = 108'h228c1520000000609005b015c00;  // minor 1 2
      8'd35: microcode = 108'h229414e0000001489005b035c00;  // minor 1 2
      8'd36: microcode = 108'h227c13e0000000609005b0050e0;  // xx
      8'd37: microcode = 108'h228c1460000000409005b0050e0;  // xx
      8'd38: microcode = 108'h229c14e0000000409005b0050e0;  // xx
      8'd39: microcode = 108'h24000000c07840489005b0250e0;  // xx
      8'd40: microcode = 108'h1041d7000000002a0005b02c860;  // weight of the area
      8'd41: microcode = 108'h52e4220ec8000a2a0005b02d060;  // peak
      8'd42: microcode = 108'h62305760000000ad8af01037800;  // 1/2 - d (1/3 ..)
      8'd43: microcode = 108'h72fc17c04840102a7c001038200;  // cut-off above 0
      8'd44: microcode = 108'h30c1d5e00000012d46581036000;  // 1/yy, defect
      8'd45: microcode = 108'h125420007800002d827006e40e0;  // position v
      8'd46: microcode = 108'h126c1380b840102a7c05b033a00;  // ratio v, from above
      8'd47: microcode = 108'h125020006800002d826006e30e0;  // position u
      8'd48: microcode = 108'h125c13009840102a7c05b033200;  // ratio u, from above
      8'd49: microcode = 108'h32c40000007840220405b010c20;  // 1/determinant
      8'd50: microcode = 108'h32c416400000000a0405b030c20;  // 1/determinant
      8'd51: microcode = 108'h42d000000078402204041016c00;  // 1/density
      8'd52: microcode = 108'h42d016a00000000a04041036c00;  // 1/density
      8'd53: microcode = 108'h24012205000092d46581032400;  // 1/z or 1, defect
      8'd54: microcode = 108'h83100000057640227c05f018a00;  // extent u
      8'd55: microcode = 108'h831000000438000a7c05f038a00;  // extent u
      8'd56: microcode = 108'h83180000057640227c05f018e00;  // extent v
      8'd57: microcode = 108'h831800000438000a7c05f038e00;  // extent v
      8'd58: microcode = 108'h22a80000007840609005b0060e0;  // yy
      8'd59: microcode = 108'h24000000c07840489005b0260e0;  // yy
      8'd60: microcode = 108'h227c1420000000609005b010420;  // xy
      8'd61: microcode = 108'h228c14a0000000409005b010420;  // xy
      8'd62: microcode = 108'h229c1520000000489005b030420;  // xy
      8'd63: microcode = 108'h40c1d0c20000002a0005b02c060;  // horizontal
      8'd64: microcode = 108'h20a1c000007840609005b015600;  // trace
      8'd65: microcode = 108'h22a80000007840489005b035600;  // trace
      8'd66: microcode = 108'h51a0c000063c402d72d01031820;  // rest
      8'd67: microcode = 108'h623057800000002d70001037a00;  // d (1/2 ..)
      8'd68: microcode = 108'h730018211840202a7c001038400;  // cut-off
      8'd69: microcode = 108'h32bc0000007840220405b0070e0;  // 1/yy
      8'd70: microcode = 108'h32bc16000000000a0405b0270e0;  // 1/yy
      8'd71: microcode = 108'h11d04000007840609005b014800;  // sheared 1 v
      8'd72: microcode = 108'h12740ec2000001489005b034800;  // sheared 1 v
      8'd73: microcode = 108'h11c84000007840609005b014400;  // sheared 1 u
      8'd74: microcode = 108'h12640ec2000001489005b034400;  // sheared 1 u
      8'd75: microcode = 108'h11e04000007840609005b014c00;  // sheared 2 u
      8'd76: microcode = 108'h12640f82000001489005b034c00;  // sheared 2 u
      8'd77: microcode = 108'h322050c20000002a0005b031420;  // density squared
      8'd78: microcode = 108'h2440000007840220404b012600;  // 1/z or 1
      8'd79: microcode = 108'h24412400000000a0404b032600;  // 1/z or 1
      8'd80: microcode = 108'h11b058a0007840609005b013c15;  // sheared 0 u; out: extent u
      8'd81: microcode = 108'h12640e02000001489005b033c00;  // sheared 0 u
      8'd82: microcode = 108'h11b858e0007840609005b014016;  // sheared 0 v; out: extent v
      8'd83: microcode = 108'h12740e02000001489005b034000;  // sheared 0 v
      8'd84: microcode = 108'h11e84000007840609005b015000;  // sheared 2 v
      8'd85: microcode = 108'h12740f82000001489005b035000;  // sheared 2 v
      8'd86: microcode = 108'h14000000507840609005b011020;  // slant
      8'd87: microcode = 108'h12641320000000409005b011020;  // slant
      8'd88: microcode = 108'h127413a0000000489005b031020;  // slant
      8'd89: microcode = 108'h320850c20000002a0005b02a0e0;  // cross
      8'd90: microcode = 108'h22b01580000000609005b010820;  // determinant
      8'd91: microcode = 108'h22b415a0000000409005b010820;  // determinant
      8'd92: microcode = 108'h22b815c0000000409005b010820;  // determinant
      8'd93: microcode = 108'h22ac2000c00000489005b030820;  // determinant
      8'd94: microcode = 108'h42cc0000007840629405b016e00;  // density, twice
      8'd95: microcode = 108'h422856c00000004a9405b036e00;  // density, twice
      8'd96: microcode = 108'h52306000e00000ad8ad81037400;  // 1/4 - d/5
      8'd97: microcode = 108'h129010020000002a0005b034a00;  // column 1 v
      8'd98: microcode = 108'h3210470e0000002a0005b0280e0;  // squared_width
      8'd99: microcode = 108'h12880fc20000002a0005b034600;  // column 1 u
      8'd100: microcode = 108'h730800000078802a7c05f038600;  // cut-off, 16 bits
      8'd101: microcode = 108'h12980fc20000002a0005b034e00;  // column 2 u
      8'd102: microcode = 108'h32284000057640227c041016600;  // density, seed
      8'd103: microcode = 108'h322840000438000a7c041036600;  // density, seed
      8'd104: microcode = 108'h24c20006800002a0005b02fc20;  // gain u
      8'd105: microcode = 108'h23c12600000002a0004b032a00;  // on plane v
      8'd106: microcode = 108'h23812600000002a0004b032800;  // on plane u
      8'd107: microcode = 108'h24c20007800002a0005b030020;  // gain v
      8'd108: microcode = 108'h128010020000002a0005b034200;  // column 0 v
      8'd109: microcode = 108'h12780fc20000002a0005b033e00;  // column 0 u
      8'd110: microcode = 108'h12a010020000002a0005b035200;  // column 2 v
      8'd111: microcode = 108'h61a0c0000778002562f80a97c00;  // cut-off, unlimited
      8'd112: microcode = 108'h61a0e0010087c00560000a97c00;  // cut-off, unlimited
      8'd113: microcode = 108'h61a0e0010887c00560000a97c00;  // cut-off, unlimited
      8'd114: microcode = 108'h623040000078400560000a97c00;  // cut-off, unlimited
      8'd115: microcode = 108'h623057a00000008d60000ab7c00;  // cut-off, unlimited
      8'd116: microcode = 108'h640000004878400d60000037e00;  // above 0
      8'd117: microcode = 108'h640000011078408d60000038000;  // beyond the end
      8'd118: microcode = 108'h22104000036980227c001016200;  // 1/determinant, seed
      8'd119: microcode = 108'h22104000022bc10a7c001036200;  // 1/determinant, seed
      8'd120: microcode = 108'h4190d6e00000002a0005b037200;  // peak of the profile
      8'd121: microcode = 108'h52305740000000ad8ae81037600;  // 1/3 - d (1/4 ..)
      8'd122: microcode = 108'h20c1c000036980227c001015e00;  // 1/yy, seed
      8'd123: microcode = 108'h20c1c000022bc10a7c001035e00;  // 1/yy, seed
      8'd124: microcode = 108'h3208470e0000002a0005b0290e0;  // shear
      8'd125: microcode = 108'h730c050e0000002a0005f038800;  // extent squared u
      8'd126: microcode = 108'h730c060e0000002a0005f038c00;  // extent squared v
      8'd127: microcode = 108'h30a1d0c20000002a0005b02b0e0;  // conic c
      8'd128: microcode = 108'h32cc0000036980227c001016800;  // 1/density, seed
      8'd129: microcode = 108'h32cc0000022bc10a7c001036800;  // 1/density, seed
      8'd130: microcode = 108'h25400000078402d82a00033400;  // above the least ratio v
      8'd131: microcode = 108'h2540000007840ad82a80033600;  // below the largest ratio v
      8'd132: microcode = 108'h2500000007840ad82880032e00;  // below the largest ratio u
      8'd133: microcode = 108'h25000000078402d82800032c00;  // above the least ratio u
      8'd134: microcode = 108'h1f850020000002a0005b037000;  // area
      default: microcode = 108'h0;
    endcase
  endfunction

endpackage
