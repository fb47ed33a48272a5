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
  localparam int LATENCY = 25;  // cycles from a sum's last slot to its use
  localparam int LOAD_AHEAD = 48;  // cycles before a round's end from which its records are full
  localparam int OUT_ROUND = 9;  // round in which a splat's results come
  localparam int OUT_LAST = 15;  // the last slot with one of them
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
      8'd0: microcode = 108'h81c201e6000002200043017811;  // z; out: z, high
      8'd1: microcode = 108'h824221e6800000200043017810;  // z; out: z, low
      8'd2: microcode = 108'h82c250e700000020004301781e;  // z; out: position u, high
      8'd3: microcode = 108'h804260e7800000200043017812;  // z; out: position u, low
      8'd4: microcode = 108'h80c270e800000020004301781f;  // z; out: position v, high
      8'd5: microcode = 108'h814280e8800000a00043017814;  // z; out: position v, low
      8'd6: microcode = 108'h8042b0e600000120004301781a;  // z; out: 1/yy
      8'd7: microcode = 108'h80c2e0e6800000200043017819;  // z; out: shear
      8'd8: microcode = 108'h8142c0e7000000a00043037817;  // z; out: horizontal
      8'd9: microcode = 108'h400100e9078400a7c0000201fc;  // z, high; out: conic c
      8'd10: microcode = 108'h4000f0e9078400a7c0010221fb;  // z, low; out: cross
      8'd11: microcode = 108'h81c2d0e3000002200043017618;  // y; out: squared_width
      8'd12: microcode = 108'h8243286380000020004301761d;  // y; out: peak
      8'd13: microcode = 108'h82c37024000000200043017613;  // y; out: cut-off
      8'd14: microcode = 108'h8043e004800000200043017615;  // y; out: extent u
      8'd15: microcode = 108'h80c3e405000000200043017616;  // y; out: extent v
      8'd16: microcode = 108'h81420005800000a00043017600;  // y
      8'd17: microcode = 108'h80420003000001200043017600;  // y
      8'd18: microcode = 108'h80c20003800000200043017600;  // y
      8'd19: microcode = 108'h81420004000000a00043037600;  // y
      8'd20: microcode = 108'h81c20000000002200043017400;  // x
      8'd21: microcode = 108'h82420000800000200043017400;  // x
      8'd22: microcode = 108'h82c20001000000200043017400;  // x
      8'd23: microcode = 108'h80420001800000200043017400;  // x
      8'd24: microcode = 108'h80c20002000000200043017400;  // x
      8'd25: microcode = 108'h81420002800000a00043017400;  // x
      8'd26: microcode = 108'h80420000000001200043017400;  // x
      8'd27: microcode = 108'h80c20000800000200043017400;  // x
      8'd28: microcode = 108'h81420001000000a00043037400;  // x
      8'd29: microcode = 108'h83020009800006264047014820;  // axis 2, row 0
      8'd30: microcode = 108'h8382000a000004264047014820;  // axis 2, row 0
      8'd31: microcode = 108'h8342000a800004a64047034820;  // axis 2, row 0
      8'd32: microcode = 108'h8302000b000006264047014c20;  // axis 2, row 1
      8'd33: microcode = 108'h8382000b800004264047014c20;  // axis 2, row 1
      8'd34: microcode = 108'h8342000c000004a64047034c20;  // axis 2, row 1
      8'd35: microcode = 108'h81820009800006264047013c20;  // axis 1, row 0
      8'd36: microcode = 108'h8202000a000004264047013c20;  // axis 1, row 0
      8'd37: microcode = 108'h8282000a800004a64047033c20;  // axis 1, row 0
      8'd38: microcode = 108'h8302000c800006264047015020;  // axis 2, row 2
      8'd39: microcode = 108'h8382000d000004264047015020;  // axis 2, row 2
      8'd40: microcode = 108'h8342000d800004a64047035020;  // axis 2, row 2
      8'd41: microcode = 108'h8182000c800006264047014420;  // axis 1, row 2
      8'd42: microcode = 108'h8202000d000004264047014420;  // axis 1, row 2
      8'd43: microcode = 108'h8282000d800004a64047034420;  // axis 1, row 2
      8'd44: microcode = 108'h80020009800006264047013020;  // axis 0, row 0
      8'd45: microcode = 108'h8082000a000004264047013020;  // axis 0, row 0
      8'd46: microcode = 108'h8102000a800004a64047033020;  // axis 0, row 0
      8'd47: microcode = 108'h8002000b000006264047013420;  // axis 0, row 1
      8'd48: microcode = 108'h8082000b800004264047013420;  // axis 0, row 1
      8'd49: microcode = 108'h8102000c000004a64047033420;  // axis 0, row 1
      8'd50: microcode = 108'h8182000b000006264047014020;  // axis 1, row 1
      8'd51: microcode = 108'h8202000b800004264047014020;  // axis 1, row 1
      8'd52: microcode = 108'h8282000c000004a64047034020;  // axis 1, row 1
      8'd53: microcode = 108'h8002000c800006264047013820;  // axis 0, row 2
      8'd54: microcode = 108'h8082000d000004264047013820;  // axis 0, row 2
      8'd55: microcode = 108'h8102000d800004a64047033820;  // axis 0, row 2
      8'd56: microcode = 108'h83c00000078402a7c0010240e0;  // weight
      8'd57: microcode = 108'h2f00000e36988227c001017a00;  // 1/z or 1, seed
      8'd58: microcode = 108'h2f00000e22bc90a7c001037a00;  // 1/z or 1, seed
      8'd59: microcode = 108'h130818012040102a7c001038800;  // ratio u, from below
      8'd60: microcode = 108'h131818214040102a7c001039000;  // ratio v, from below
      8'd61: microcode = 108'h232c196000000060680470090e0;  // xx
      8'd62: microcode = 108'h233c19e000000040680470090e0;  // xx
      8'd63: microcode = 108'h234c1a6000000040680470090e0;  // xx
      8'd64: microcode = 108'h2400000150784048680470290e0;  // xx
      8'd65: microcode = 108'h232c1aa0000000606804701b200;  // minor 0 2
      8'd66: microcode = 108'h23341a60000001486804703b200;  // minor 0 2
      8'd67: microcode = 108'h32c05ba00000012d46e8103bc00;  // 1/determinant, defect
      8'd68: microcode = 108'h42d04000036980227c00101c000;  // 1/density, seed
      8'd69: microcode = 108'h42d04000022bc10a7c00103c000;  // 1/density, seed
      8'd70: microcode = 108'h1081dc800000002a000470310e0;  // weight of the area
      8'd71: microcode = 108'h5221dc600000002a0004703ca00;  // peak of the profile
      8'd72: microcode = 108'h62d85cc0000000ad8b78103ce00;  // 1/3 - d (1/4 ..)
      8'd73: microcode = 108'h7250c0000778002563880a9d400;  // cut-off, unlimited
      8'd74: microcode = 108'h7250e0019087c00560000a9d400;  // cut-off, unlimited
      8'd75: microcode = 108'h7250e0019887c00560000a9d400;  // cut-off, unlimited
      8'd76: microcode = 108'h72d840000078400560000a9d400;  // cut-off, unlimited
      8'd77: microcode = 108'h72d85d200000008d60000abd400;  // cut-off, unlimited
      8'd78: microcode = 108'h740000009078400d6000003d600;  // above 0
      8'd79: microcode = 108'h74000001a078408d6000003d800;  // beyond the end
      8'd80: microcode = 108'h23580000007840606804700a0e0;  // yy
      8'd81: microcode = 108'h24000001507840486804702a0e0;  // yy
      8'd82: microcode = 108'h83b80a0e0000002a0005f03e200;  // extent squared v
      8'd83: microcode = 108'h2f017a0e000092d46e81037c00;  // 1/z or 1, defect
      8'd84: microcode = 108'h130c18812840102a7c047038a00;  // ratio u, from above
      8'd85: microcode = 108'h131c19014840102a7c047039200;  // ratio v, from above
      8'd86: microcode = 108'h13002000f800002d82f000250e0;  // position u, high
      8'd87: microcode = 108'h140000009078400d800010260e0;  // position u, low
      8'd88: microcode = 108'h83b8090e0000002a0005f03de00;  // extent squared u
      8'd89: microcode = 108'h2121c000007840606804701ae00;  // trace
      8'd90: microcode = 108'h23580000007840486804703ae00;  // trace
      8'd91: microcode = 108'h42b85be00000002a0004702f0e0;  // cross
      8'd92: microcode = 108'h33740000007840220404701be00;  // 1/determinant
      8'd93: microcode = 108'h33741bc00000000a0404703be00;  // 1/determinant
      8'd94: microcode = 108'h42d05c000000012d46e8103c200;  // 1/density, defect
      8'd95: microcode = 108'h42c04b0e0000002a0004702d0e0;  // squared_width
      8'd96: microcode = 108'h5394240f58000a2a00047032860;  // peak
      8'd97: microcode = 108'h62d85ce0000000ad8b80103d000;  // 1/2 - d (1/3 ..)
      8'd98: microcode = 108'h336c0000007840220404700b0e0;  // 1/yy
      8'd99: microcode = 108'h336c1b800000000a0404702b0e0;  // 1/yy
      8'd100: microcode = 108'h232c19a00000006068047015c20;  // xy
      8'd101: microcode = 108'h233c1a200000004068047015c20;  // xy
      8'd102: microcode = 108'h234c1aa00000004868047035c20;  // xy
      8'd103: microcode = 108'h73ac1d409040102a7c00103da00;  // cut-off above 0
      8'd104: microcode = 108'h130420010800002d830000270e0;  // position v, high
      8'd105: microcode = 108'h140000009078400d800010280e0;  // position v, low
      8'd106: microcode = 108'h2141c000036980227c00101b600;  // 1/yy, seed
      8'd107: microcode = 108'h2141c000022bc10a7c00103b600;  // 1/yy, seed
      8'd108: microcode = 108'h2f400000078402204043017e00;  // 1/z or 1
      8'd109: microcode = 108'h2f417c00000000a04043037e00;  // 1/z or 1
      8'd110: microcode = 108'h12984000007840606804701a800;  // sheared 2 v
      8'd111: microcode = 108'h13241502000001486804703a800;  // sheared 2 v
      8'd112: microcode = 108'h126840000078406068047019800;  // sheared 0 v
      8'd113: microcode = 108'h132413820000014868047039800;  // sheared 0 v
      8'd114: microcode = 108'h12804000007840606804701a000;  // sheared 1 v
      8'd115: microcode = 108'h13241442000001486804703a000;  // sheared 1 v
      8'd116: microcode = 108'h127840000078406068047019c00;  // sheared 1 u
      8'd117: microcode = 108'h131414420000014868047039c00;  // sheared 1 u
      8'd118: microcode = 108'h12904000007840606804701a400;  // sheared 2 u
      8'd119: microcode = 108'h13141502000001486804703a400;  // sheared 2 u
      8'd120: microcode = 108'h126040000078406068047019400;  // sheared 0 u
      8'd121: microcode = 108'h131413820000014868047039400;  // sheared 0 u
      8'd122: microcode = 108'h23601b000000006068047016020;  // determinant
      8'd123: microcode = 108'h23641b200000004068047016020;  // determinant
      8'd124: microcode = 108'h23681b400000004068047016020;  // determinant
      8'd125: microcode = 108'h235c20015000004868047036020;  // determinant
      8'd126: microcode = 108'h14000000e078406068047012060;  // slant
      8'd127: microcode = 108'h131418a00000004068047012060;  // slant
      8'd128: microcode = 108'h132419200000004868047032060;  // slant
      8'd129: microcode = 108'h3240dbe00000002a00047036420;  // density squared
      8'd130: microcode = 108'h43800000007840220404101c400;  // 1/density
      8'd131: microcode = 108'h43801c200000000a0404103c400;  // 1/density
      8'd132: microcode = 108'h5250c000063c402d73601036c20;  // rest
      8'd133: microcode = 108'h62d85d000000002d7000103d200;  // d (1/2 ..)
      8'd134: microcode = 108'h2e817e00000002a00043038000;  // on plane u
      8'd135: microcode = 108'h2ec17e00000002a00043038200;  // on plane v
      8'd136: microcode = 108'h2fc20010800002a00047035820;  // gain v
      8'd137: microcode = 108'h2fc2000f800002a00047035420;  // gain u
      8'd138: microcode = 108'h133015820000002a00047039a00;  // column 0 v
      8'd139: microcode = 108'h135015820000002a0004703aa00;  // column 2 v
      8'd140: microcode = 108'h134015820000002a0004703a200;  // column 1 v
      8'd141: microcode = 108'h73b01da1a840202a7c001037020;  // cut-off
      8'd142: microcode = 108'h133815420000002a00047039e00;  // column 1 u
      8'd143: microcode = 108'h2141db600000012d46e8103b800;  // 1/yy, defect
      8'd144: microcode = 108'h134815420000002a0004703a600;  // column 2 u
      8'd145: microcode = 108'h32b84b0e0000002a0004702e0e0;  // shear
      8'd146: microcode = 108'h132815420000002a00047039600;  // column 0 u
      8'd147: microcode = 108'h83bc0000057640227c05f01e000;  // extent u
      8'd148: microcode = 108'h83bc00000438000a7c05f03e000;  // extent u
      8'd149: microcode = 108'h3141dbe00000002a0004702c0e0;  // horizontal
      8'd150: microcode = 108'h22c04000036980227c00101ba00;  // 1/determinant, seed
      8'd151: microcode = 108'h22c04000022bc10a7c00103ba00;  // 1/determinant, seed
      8'd152: microcode = 108'h83c40000057640227c05f01e400;  // extent v
      8'd153: microcode = 108'h83c400000438000a7c05f03e400;  // extent v
      8'd154: microcode = 108'h32c84000057640227c041016820;  // density, seed
      8'd155: microcode = 108'h32c840000438000a7c041036820;  // density, seed
      8'd156: microcode = 108'h42d04000007840626c04701c600;  // density, twice
      8'd157: microcode = 108'h42c85c400000004a6c04703c600;  // density, twice
      8'd158: microcode = 108'h52d86001700000ad8b68103cc00;  // 1/4 - d/5
      8'd159: microcode = 108'h30000000078402d83100038400;  // above the least ratio u
      8'd160: microcode = 108'h3000000007840ad83180038600;  // below the largest ratio u
      8'd161: microcode = 108'h3040000007840ad83380038e00;  // below the largest ratio v
      8'd162: microcode = 108'h30400000078402d83300038c00;  // above the least ratio v
      8'd163: microcode = 108'h2a855820000002a0004703c800;  // area
      8'd164: microcode = 108'h3121dbe00000002a000470300e0;  // conic c
      8'd165: microcode = 108'h133419a0000000606804701ac00;  // yy, sharp
      8'd166: microcode = 108'h13441a20000000406804701ac00;  // yy, sharp
      8'd167: microcode = 108'h13541aa0000000486804703ac00;  // yy, sharp
      8'd168: microcode = 108'h72e040000078802a7c05f03dc00;  // cut-off, 16 bits
      8'd169: microcode = 108'h133c1aa0000000606804701b400;  // minor 1 2
      8'd170: microcode = 108'h13441a60000001486804703b400;  // minor 1 2
      8'd171: microcode = 108'h132c1a20000000606804701b000;  // minor 0 1
      8'd172: microcode = 108'h133419e0000001486804703b000;  // minor 0 1
      default: microcode = 108'h0;
    endcase
  endfunction

endpackage
