// Design standard24: the setup unit's program. Generated, not to be edited:
// `cargo run -p splatline-rtl --example rtl -- package`
package splatline_setup_pkg;

  localparam int POSITION = 48;  // magnitude bits of a difference to the eye
  localparam int LOW = 18;  // those of its low part
  localparam int FAINT = 0;  // those of a position that are below its centre's rounding; 0: it comes in two words
  localparam int MANTISSA = 28;  // magnitude bits of a mantissa
  localparam int AXIS_DROP = 0;  // bits of an axis' components that are 0
  localparam int TURNED = 0;  // do axes come turned?
  localparam int ROUND = 173;  // cycles of a round
  localparam int LATENCY = 22;  // cycles from a sum's last slot to its use
  localparam int LOAD_AHEAD = 48;  // cycles before a round's end from which its records are full
  localparam int OUT_ROUND = 7;  // round in which a splat's results come
  localparam int OUT_LAST = 143;  // the last slot with one of them
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
      8'd0: microcode = 108'h81c200e6000002200043011c11;  // z; out: z, high
      8'd1: microcode = 108'h824210e6800000200043011c10;  // z; out: z, low
      8'd2: microcode = 108'h82c250e7000000200043011c1f;  // z; out: position v, high
      8'd3: microcode = 108'h804260e7800000200043011c14;  // z; out: position v, low
      8'd4: microcode = 108'h80c230e8000000200043011c1e;  // z; out: position u, high
      8'd5: microcode = 108'h814240e8800000a00043011c12;  // z; out: position u, low
      8'd6: microcode = 108'h8042c866000001200043011c1c;  // z; out: conic c
      8'd7: microcode = 108'h80c2c066800000200043011c1b;  // z; out: cross
      8'd8: microcode = 108'h8142a867000000a00043031c17;  // z; out: horizontal
      8'd9: microcode = 108'h4000a069078400a7c0000200fa;  // z, high; out: 1/yy
      8'd10: microcode = 108'h4000d869078400a7c0010210fd;  // z, low; out: peak
      8'd11: microcode = 108'h81c2b063000002200043011a18;  // y; out: squared_width
      8'd12: microcode = 108'h8242b863800000200043011a19;  // y; out: shear
      8'd13: microcode = 108'h82c38204000000200043011a13;  // y; out: cut-off
      8'd14: microcode = 108'h80420004800000200043011a00;  // y
      8'd15: microcode = 108'h80c20005000000200043011a00;  // y
      8'd16: microcode = 108'h81420005800000a00043011a00;  // y
      8'd17: microcode = 108'h80420003000001200043011a00;  // y
      8'd18: microcode = 108'h80c20003800000200043011a00;  // y
      8'd19: microcode = 108'h81420004000000a00043031a00;  // y
      8'd20: microcode = 108'h81c20000000002200043011800;  // x
      8'd21: microcode = 108'h82420000800000200043011800;  // x
      8'd22: microcode = 108'h82c20001000000200043011800;  // x
      8'd23: microcode = 108'h80420001800000200043011800;  // x
      8'd24: microcode = 108'h80c20002000000200043011800;  // x
      8'd25: microcode = 108'h81420002800000a00043011800;  // x
      8'd26: microcode = 108'h80420000000001200043011800;  // x
      8'd27: microcode = 108'h80c20000800000200043011800;  // x
      8'd28: microcode = 108'h81420001000000a00043031800;  // x
      8'd29: microcode = 108'h8182000980000626404700ec20;  // axis 1, row 0
      8'd30: microcode = 108'h8202000a00000426404700ec20;  // axis 1, row 0
      8'd31: microcode = 108'h8282000a800004a6404702ec20;  // axis 1, row 0
      8'd32: microcode = 108'h8302000b00000626404700fc20;  // axis 2, row 1
      8'd33: microcode = 108'h8382000b80000426404700fc20;  // axis 2, row 1
      8'd34: microcode = 108'h8342000c000004a6404702fc20;  // axis 2, row 1
      8'd35: microcode = 108'h8302000c800006264047010020;  // axis 2, row 2
      8'd36: microcode = 108'h8382000d000004264047010020;  // axis 2, row 2
      8'd37: microcode = 108'h8342000d800004a64047030020;  // axis 2, row 2
      8'd38: microcode = 108'h8182000b00000626404700f020;  // axis 1, row 1
      8'd39: microcode = 108'h8202000b80000426404700f020;  // axis 1, row 1
      8'd40: microcode = 108'h8282000c000004a6404702f020;  // axis 1, row 1
      8'd41: microcode = 108'h8002000980000626404700e020;  // axis 0, row 0
      8'd42: microcode = 108'h8082000a00000426404700e020;  // axis 0, row 0
      8'd43: microcode = 108'h8102000a800004a6404702e020;  // axis 0, row 0
      8'd44: microcode = 108'h8002000b00000626404700e420;  // axis 0, row 1
      8'd45: microcode = 108'h8082000b80000426404700e420;  // axis 0, row 1
      8'd46: microcode = 108'h8102000c000004a6404702e420;  // axis 0, row 1
      8'd47: microcode = 108'h8002000c80000626404700e820;  // axis 0, row 2
      8'd48: microcode = 108'h8082000d00000426404700e820;  // axis 0, row 2
      8'd49: microcode = 108'h8102000d800004a6404702e820;  // axis 0, row 2
      8'd50: microcode = 108'h8182000c80000626404700f420;  // axis 1, row 2
      8'd51: microcode = 108'h8202000d00000426404700f420;  // axis 1, row 2
      8'd52: microcode = 108'h8282000d800004a6404702f420;  // axis 1, row 2
      8'd53: microcode = 108'h8302000980000626404700f820;  // axis 2, row 0
      8'd54: microcode = 108'h8382000a00000426404700f820;  // axis 2, row 0
      8'd55: microcode = 108'h8342000a800004a6404702f820;  // axis 2, row 0
      8'd56: microcode = 108'h83c00000078402a7c0010220e0;  // weight
      8'd57: microcode = 108'h2380000e36988227c001011e00;  // 1/z or 1, seed
      8'd58: microcode = 108'h2380000e22bc90a7c001031e00;  // 1/z or 1, seed
      8'd59: microcode = 108'h125c13012840102a7c047033200;  // ratio u, from above
      8'd60: microcode = 108'h126c13814840102a7c047033a00;  // ratio v, from above
      8'd61: microcode = 108'h22b015800000006068047009860;  // determinant
      8'd62: microcode = 108'h22b415a00000004068047009860;  // determinant
      8'd63: microcode = 108'h22b815c00000004068047009860;  // determinant
      8'd64: microcode = 108'h22ac20015000004868047029860;  // determinant
      8'd65: microcode = 108'h32204000057640227c041016400;  // density, seed
      8'd66: microcode = 108'h322040000438000a7c041036400;  // density, seed
      8'd67: microcode = 108'h1041d6e00000002a0004702d060;  // weight of the area
      8'd68: microcode = 108'h41a0d6c00000002a00047037000;  // peak of the profile
      8'd69: microcode = 108'h52285720000000ad8b781037400;  // 1/3 - d (1/4 ..)
      8'd70: microcode = 108'h2101c000036980227c001010420;  // 1/yy, seed
      8'd71: microcode = 108'h2101c000022bc10a7c001030420;  // 1/yy, seed
      8'd72: microcode = 108'h62f817a09040102a7c001038000;  // cut-off above 0
      8'd73: microcode = 108'h73140000057640227c05f018c00;  // extent v
      8'd74: microcode = 108'h731400000438000a7c05f038c00;  // extent v
      8'd75: microcode = 108'h227c14200000006068047009060;  // xy
      8'd76: microcode = 108'h228c14a00000004068047009060;  // xy
      8'd77: microcode = 108'h229c15200000004868047029060;  // xy
      8'd78: microcode = 108'h12482000f800002d82f000230e0;  // position u, high
      8'd79: microcode = 108'h140000009078400d800010240e0;  // position u, low
      8'd80: microcode = 108'h23811e0e000092d46e81032000;  // 1/z or 1, defect
      8'd81: microcode = 108'h11f040000078406068047014c00;  // sheared 2 u
      8'd82: microcode = 108'h126410020000014868047034c00;  // sheared 2 u
      8'd83: microcode = 108'h11d840000078406068047014400;  // sheared 1 u
      8'd84: microcode = 108'h12640f420000014868047034400;  // sheared 1 u
      8'd85: microcode = 108'h11c040000078406068047013c00;  // sheared 0 u
      8'd86: microcode = 108'h12640e820000014868047033c00;  // sheared 0 u
      8'd87: microcode = 108'h11e040000078406068047014800;  // sheared 1 v
      8'd88: microcode = 108'h12740f420000014868047034800;  // sheared 1 v
      8'd89: microcode = 108'h11c840000078406068047014000;  // sheared 0 v
      8'd90: microcode = 108'h12740e820000014868047034000;  // sheared 0 v
      8'd91: microcode = 108'h11f840000078406068047015000;  // sheared 2 v
      8'd92: microcode = 108'h127410020000014868047035000;  // sheared 2 v
      8'd93: microcode = 108'h2130c000036980227c001015e00;  // 1/determinant, seed
      8'd94: microcode = 108'h2130c000022bc10a7c001035e00;  // 1/determinant, seed
      8'd95: microcode = 108'h14000000e078406068047010c20;  // slant
      8'd96: microcode = 108'h126413200000004068047010c20;  // slant
      8'd97: microcode = 108'h127413a00000004868047030c20;  // slant
      8'd98: microcode = 108'h32c818c0036980227c001016616;  // 1/density, seed; out: extent v
      8'd99: microcode = 108'h32c80000022bc10a7c001036600;  // 1/density, seed
      8'd100: microcode = 108'h42e0220f58000a2a0004702d860;  // peak
      8'd101: microcode = 108'h52285740000000ad8b801037600;  // 1/2 - d (1/3 ..)
      8'd102: microcode = 108'h23c00000078402204043012200;  // 1/z or 1
      8'd103: microcode = 108'h23c12000000000a04043032200;  // 1/z or 1
      8'd104: microcode = 108'h129812800000002a00047034e00;  // column 2 u
      8'd105: microcode = 108'h62fc1801a840202a7c001038200;  // cut-off
      8'd106: microcode = 108'h128812800000002a00047034600;  // column 1 u
      8'd107: microcode = 108'h2101d0420000012d46e81030820;  // 1/yy, defect
      8'd108: microcode = 108'h127812800000002a00047033e00;  // column 0 u
      8'd109: microcode = 108'h30e1d6200000002a0004702c860;  // conic c
      8'd110: microcode = 108'h129012a00000002a00047034a00;  // column 1 v
      8'd111: microcode = 108'h4130ca060000002a0004702b060;  // squared_width
      8'd112: microcode = 108'h128012a00000002a00047034200;  // column 0 v
      8'd113: microcode = 108'h3120d6200000002a0004702c060;  // cross
      8'd114: microcode = 108'h12a012a00000002a00047035200;  // column 2 v
      8'd115: microcode = 108'h3101d6200000002a0004702a860;  // horizontal
      8'd116: microcode = 108'h2130d5e00000012d46e81036000;  // 1/determinant, defect
      8'd117: microcode = 108'h32084000007840220404700a060;  // 1/yy
      8'd118: microcode = 108'h320850820000000a0404702a060;  // 1/yy
      8'd119: microcode = 108'h730c0000057640227c05f018800;  // extent u
      8'd120: microcode = 108'h730c00000438000a7c05f038800;  // extent u
      8'd121: microcode = 108'h32c816600000012d46e81036800;  // 1/density, defect
      8'd122: microcode = 108'h41b0c000063c402d73601031420;  // rest
      8'd123: microcode = 108'h522857600000002d70001037800;  // d (1/2 ..)
      8'd124: microcode = 108'h4120ca060000002a0004702b860;  // shear
      8'd125: microcode = 108'h23012200000002a00043032400;  // on plane u
      8'd126: microcode = 108'h23412200000002a00043032600;  // on plane v
      8'd127: microcode = 108'h2442000f800002a00047032800;  // gain u
      8'd128: microcode = 108'h24420010800002a00047032a00;  // gain v
      8'd129: microcode = 108'h630400000078802a7c05f038400;  // cut-off, 16 bits
      8'd130: microcode = 108'h127c13e000000060680470070e0;  // xx
      8'd131: microcode = 108'h128c146000000040680470070e0;  // xx
      8'd132: microcode = 108'h129c14e000000040680470070e0;  // xx
      8'd133: microcode = 108'h1400000150784048680470270e0;  // xx
      8'd134: microcode = 108'h127c14a00000006068047015800;  // minor 0 1
      8'd135: microcode = 108'h128414600000014868047035800;  // minor 0 1
      8'd136: microcode = 108'h127c15200000006068047015a00;  // minor 0 2
      8'd137: microcode = 108'h128414e00000014868047035a00;  // minor 0 2
      8'd138: microcode = 108'h128c15200000006068047015c00;  // minor 1 2
      8'd139: microcode = 108'h129414e00000014868047035c00;  // minor 1 2
      8'd140: microcode = 108'h128414200000006068047015400;  // yy, sharp
      8'd141: microcode = 108'h129414a00000004068047015400;  // yy, sharp
      8'd142: microcode = 108'h12a415200000004868047035400;  // yy, sharp
      8'd143: microcode = 108'h22bc18800078402204047016215;  // 1/determinant; out: extent u
      8'd144: microcode = 108'h22bc16000000000a04047036200;  // 1/determinant
      8'd145: microcode = 108'h32cc00000078402204041016a00;  // 1/density
      8'd146: microcode = 108'h32cc16800000000a04041036a00;  // 1/density
      8'd147: microcode = 108'h24800000078402d83100032c00;  // above the least ratio u
      8'd148: microcode = 108'h24c00000078402d83300033400;  // above the least ratio v
      8'd149: microcode = 108'h2480000007840ad83180032e00;  // below the largest ratio u
      8'd150: microcode = 108'h24c0000007840ad83380033600;  // below the largest ratio v
      8'd151: microcode = 108'h25012a00000002a00047036e00;  // area
      8'd152: microcode = 108'h42286001700000ad8b681037200;  // 1/4 - d/5
      8'd153: microcode = 108'h51b0c0000778002563880a97a00;  // cut-off, unlimited
      8'd154: microcode = 108'h51b0e0019087c00560000a97a00;  // cut-off, unlimited
      8'd155: microcode = 108'h51b0e0019887c00560000a97a00;  // cut-off, unlimited
      8'd156: microcode = 108'h522840000078400560000a97a00;  // cut-off, unlimited
      8'd157: microcode = 108'h522857800000008d60000ab7a00;  // cut-off, unlimited
      8'd158: microcode = 108'h540000009078400d60000037c00;  // above 0
      8'd159: microcode = 108'h54000001a078408d60000037e00;  // beyond the end
      8'd160: microcode = 108'h24c20010800002d830000250e0;  // position v, high
      8'd161: microcode = 108'h40000009078400d800010260e0;  // position v, low
      8'd162: microcode = 108'h6308080e0000002a0005f038a00;  // extent squared v
      8'd163: microcode = 108'h6308070e0000002a0005f038600;  // extent squared u
      8'd164: microcode = 108'h10e1c0000078406068047015600;  // trace
      8'd165: microcode = 108'h12a800000078404868047035600;  // trace
      8'd166: microcode = 108'h221856200000002a00047031020;  // density squared
      8'd167: microcode = 108'h12a8000000784060680470080e0;  // yy
      8'd168: microcode = 108'h1400000150784048680470280e0;  // yy
      8'd169: microcode = 108'h25812412040102a7c001033000;  // ratio u, from below
      8'd170: microcode = 108'h26812614040102a7c001033800;  // ratio v, from below
      8'd171: microcode = 108'h32c80000007840626c047016c00;  // density, twice
      8'd172: microcode = 108'h322056a00000004a6c047036c00;  // density, twice
      default: microcode = 108'h0;
    endcase
  endfunction

endpackage
