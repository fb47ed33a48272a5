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
  localparam int LATENCY = 24;  // cycles from a sum's last slot to its use
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
      8'd0: microcode = 108'h80c201e6000002200043016c11;  // z; out: z, high
      8'd1: microcode = 108'h810221e6800000200043016c10;  // z; out: z, low
      8'd2: microcode = 108'h814250e7000000200043016c1e;  // z; out: position u, high
      8'd3: microcode = 108'h800260e7800000200043016c12;  // z; out: position u, low
      8'd4: microcode = 108'h804270e8000000200043016c1f;  // z; out: position v, high
      8'd5: microcode = 108'h808280e8800000a00043016c14;  // z; out: position v, low
      8'd6: microcode = 108'h8002b0e6000001200043016c1a;  // z; out: 1/yy
      8'd7: microcode = 108'h8042d0e6800000200043016c18;  // z; out: squared_width
      8'd8: microcode = 108'h8082c0e7000000a00043036c17;  // z; out: horizontal
      8'd9: microcode = 108'h4000f0e9078400a7c0000201fb;  // z, high; out: cross
      8'd10: microcode = 108'h4000e0e9078400a7c0010221f9;  // z, low; out: shear
      8'd11: microcode = 108'h80c300e3000002200043016a1c;  // y; out: conic c
      8'd12: microcode = 108'h81031863800000200043016a1d;  // y; out: peak
      8'd13: microcode = 108'h81436424000000200043016a13;  // y; out: cut-off
      8'd14: microcode = 108'h8003d404800000200043016a15;  // y; out: extent u
      8'd15: microcode = 108'h8043d805000000200043016a16;  // y; out: extent v
      8'd16: microcode = 108'h80820005800000a00043016a00;  // y
      8'd17: microcode = 108'h80020003000001200043016a00;  // y
      8'd18: microcode = 108'h80420003800000200043016a00;  // y
      8'd19: microcode = 108'h80820004000000a00043036a00;  // y
      8'd20: microcode = 108'h80c20000000002200043016800;  // x
      8'd21: microcode = 108'h81020000800000200043016800;  // x
      8'd22: microcode = 108'h81420001000000200043016800;  // x
      8'd23: microcode = 108'h80020001800000200043016800;  // x
      8'd24: microcode = 108'h80420002000000200043016800;  // x
      8'd25: microcode = 108'h80820002800000a00043016800;  // x
      8'd26: microcode = 108'h80020000000001200043016800;  // x
      8'd27: microcode = 108'h80420000800000200043016800;  // x
      8'd28: microcode = 108'h80820001000000a00043036800;  // x
      8'd29: microcode = 108'h8182000c800006264047012820;  // axis 0, row 2
      8'd30: microcode = 108'h81c2000d000004264047012820;  // axis 0, row 2
      8'd31: microcode = 108'h8202000d800004a64047032820;  // axis 0, row 2
      8'd32: microcode = 108'h8302000c800006264047014020;  // axis 2, row 2
      8'd33: microcode = 108'h8342000d000004264047014020;  // axis 2, row 2
      8'd34: microcode = 108'h8382000d800004a64047034020;  // axis 2, row 2
      8'd35: microcode = 108'h83020009800006264047013820;  // axis 2, row 0
      8'd36: microcode = 108'h8342000a000004264047013820;  // axis 2, row 0
      8'd37: microcode = 108'h8382000a800004a64047033820;  // axis 2, row 0
      8'd38: microcode = 108'h8242000c800006264047013420;  // axis 1, row 2
      8'd39: microcode = 108'h8282000d000004264047013420;  // axis 1, row 2
      8'd40: microcode = 108'h82c2000d800004a64047033420;  // axis 1, row 2
      8'd41: microcode = 108'h8242000b000006264047013020;  // axis 1, row 1
      8'd42: microcode = 108'h8282000b800004264047013020;  // axis 1, row 1
      8'd43: microcode = 108'h82c2000c000004a64047033020;  // axis 1, row 1
      8'd44: microcode = 108'h8302000b000006264047013c20;  // axis 2, row 1
      8'd45: microcode = 108'h8342000b800004264047013c20;  // axis 2, row 1
      8'd46: microcode = 108'h8382000c000004a64047033c20;  // axis 2, row 1
      8'd47: microcode = 108'h81820009800006264047012020;  // axis 0, row 0
      8'd48: microcode = 108'h81c2000a000004264047012020;  // axis 0, row 0
      8'd49: microcode = 108'h8202000a800004a64047032020;  // axis 0, row 0
      8'd50: microcode = 108'h82420009800006264047012c20;  // axis 1, row 0
      8'd51: microcode = 108'h8282000a000004264047012c20;  // axis 1, row 0
      8'd52: microcode = 108'h82c2000a800004a64047032c20;  // axis 1, row 0
      8'd53: microcode = 108'h8182000b000006264047012420;  // axis 0, row 1
      8'd54: microcode = 108'h81c2000b800004264047012420;  // axis 0, row 1
      8'd55: microcode = 108'h8202000c000004a64047032420;  // axis 0, row 1
      8'd56: microcode = 108'h83c00000078402a7c0010240e0;  // weight
      8'd57: microcode = 108'h2d80000e36988227c001016e00;  // 1/z or 1, seed
      8'd58: microcode = 108'h2d80000e22bc90a7c001036e00;  // 1/z or 1, seed
      8'd59: microcode = 108'h130017614040102a7c001038400;  // ratio v, from below
      8'd60: microcode = 108'h12f017412040102a7c001037c00;  // ratio u, from below
      8'd61: microcode = 108'h23141960000000606804701a400;  // minor 0 1
      8'd62: microcode = 108'h231c1920000001486804703a400;  // minor 0 1
      8'd63: microcode = 108'h2121c000007840606804701a200;  // trace
      8'd64: microcode = 108'h23400000007840486804703a200;  // trace
      8'd65: microcode = 108'h335c0000007840220404701b200;  // 1/determinant
      8'd66: microcode = 108'h335c1b000000000a0404703b200;  // 1/determinant
      8'd67: microcode = 108'h42b85b400000012d46e8103b600;  // 1/density, defect
      8'd68: microcode = 108'h1081dbc00000002a00047031060;  // weight of the area
      8'd69: microcode = 108'h537c240f58000a2a00047031860;  // peak
      8'd70: microcode = 108'h62c05c20000000ad8b80103c400;  // 1/2 - d (1/3 ..)
      8'd71: microcode = 108'h7230c0000778002563880a9c800;  // cut-off, unlimited
      8'd72: microcode = 108'h7230e0019087c00560000a9c800;  // cut-off, unlimited
      8'd73: microcode = 108'h7230e0019887c00560000a9c800;  // cut-off, unlimited
      8'd74: microcode = 108'h72c040000078400560000a9c800;  // cut-off, unlimited
      8'd75: microcode = 108'h72c05c600000008d60000abc800;  // cut-off, unlimited
      8'd76: microcode = 108'h740000009078400d6000003ca00;  // above 0
      8'd77: microcode = 108'h74000001a078408d6000003cc00;  // beyond the end
      8'd78: microcode = 108'h23400000007840606804700a0e0;  // yy
      8'd79: microcode = 108'h24000001507840486804702a0e0;  // yy
      8'd80: microcode = 108'h12e82000f800002d82f000250e0;  // position u, high
      8'd81: microcode = 108'h140000009078400d800010260e0;  // position u, low
      8'd82: microcode = 108'h2d816e0e000092d46e81037000;  // 1/z or 1, defect
      8'd83: microcode = 108'h130418414840102a7c047038600;  // ratio v, from above
      8'd84: microcode = 108'h12f417c12840102a7c047037e00;  // ratio u, from above
      8'd85: microcode = 108'h231418e00000006068047014c20;  // xy
      8'd86: microcode = 108'h232419600000004068047014c20;  // xy
      8'd87: microcode = 108'h233419e00000004868047034c20;  // xy
      8'd88: microcode = 108'h23481a400000006068047015020;  // determinant
      8'd89: microcode = 108'h234c1a600000004068047015020;  // determinant
      8'd90: microcode = 108'h23501a800000004068047015020;  // determinant
      8'd91: microcode = 108'h234420015000004868047035020;  // determinant
      8'd92: microcode = 108'h32a85b200000002a00047035820;  // density squared
      8'd93: microcode = 108'h43680000007840220404101b800;  // 1/density
      8'd94: microcode = 108'h43681b600000000a0404103b800;  // 1/density
      8'd95: microcode = 108'h5230c000063c402d73601036020;  // rest
      8'd96: microcode = 108'h62c05c400000002d7000103c600;  // d (1/2 ..)
      8'd97: microcode = 108'h12ec20010800002d830000270e0;  // position v, high
      8'd98: microcode = 108'h140000009078400d800010280e0;  // position v, low
      8'd99: microcode = 108'h83a0090e0000002a0005f03d200;  // extent squared u
      8'd100: microcode = 108'h73941c809040102a7c00103ce00;  // cut-off above 0
      8'd101: microcode = 108'h33540000007840220404700b0e0;  // 1/yy
      8'd102: microcode = 108'h33541ac00000000a0404702b0e0;  // 1/yy
      8'd103: microcode = 108'h2141c000036980227c00101aa00;  // 1/yy, seed
      8'd104: microcode = 108'h2141c000022bc10a7c00103aa00;  // 1/yy, seed
      8'd105: microcode = 108'h83a00a0e0000002a0005f03d600;  // extent squared v
      8'd106: microcode = 108'h2dc00000078402204043017200;  // 1/z or 1
      8'd107: microcode = 108'h2dc17000000000a04043037200;  // 1/z or 1
      8'd108: microcode = 108'h127040000078406068047019800;  // sheared 2 u
      8'd109: microcode = 108'h12fc14020000014868047039800;  // sheared 2 u
      8'd110: microcode = 108'h125840000078406068047019000;  // sheared 1 u
      8'd111: microcode = 108'h12fc13420000014868047039000;  // sheared 1 u
      8'd112: microcode = 108'h124040000078406068047018800;  // sheared 0 u
      8'd113: microcode = 108'h12fc12820000014868047038800;  // sheared 0 u
      8'd114: microcode = 108'h127840000078406068047019c00;  // sheared 2 v
      8'd115: microcode = 108'h130c14020000014868047039c00;  // sheared 2 v
      8'd116: microcode = 108'h124840000078406068047018c00;  // sheared 0 v
      8'd117: microcode = 108'h130c12820000014868047038c00;  // sheared 0 v
      8'd118: microcode = 108'h126040000078406068047019400;  // sheared 1 v
      8'd119: microcode = 108'h130c13420000014868047039400;  // sheared 1 v
      8'd120: microcode = 108'h22a04000036980227c00101ae00;  // 1/determinant, seed
      8'd121: microcode = 108'h22a04000022bc10a7c00103ae00;  // 1/determinant, seed
      8'd122: microcode = 108'h14000000e078406068047015420;  // slant
      8'd123: microcode = 108'h12fc17e00000004068047015420;  // slant
      8'd124: microcode = 108'h130c18600000004868047035420;  // slant
      8'd125: microcode = 108'h32b04000057640227c041015c20;  // density, seed
      8'd126: microcode = 108'h32b040000438000a7c041035c20;  // density, seed
      8'd127: microcode = 108'h42b84000007840626c04701ba00;  // density, twice
      8'd128: microcode = 108'h42b05b800000004a6c04703ba00;  // density, twice
      8'd129: microcode = 108'h52c06001700000ad8b68103c000;  // 1/4 - d/5
      8'd130: microcode = 108'h2141daa00000012d46e8103ac00;  // 1/yy, defect
      8'd131: microcode = 108'h2d017200000002a00043037400;  // on plane u
      8'd132: microcode = 108'h2d417200000002a00043037600;  // on plane v
      8'd133: microcode = 108'h2e42000f800002a00047034420;  // gain u
      8'd134: microcode = 108'h133014420000002a00047039a00;  // column 2 u
      8'd135: microcode = 108'h132014420000002a00047039200;  // column 1 u
      8'd136: microcode = 108'h2e420010800002a00047034820;  // gain v
      8'd137: microcode = 108'h131014420000002a00047038a00;  // column 0 u
      8'd138: microcode = 108'h73981ce1a840202a7c001036420;  // cut-off
      8'd139: microcode = 108'h133814820000002a00047039e00;  // column 2 v
      8'd140: microcode = 108'h32a04b0e0000002a0004702d0e0;  // squared_width
      8'd141: microcode = 108'h131814820000002a00047038e00;  // column 0 v
      8'd142: microcode = 108'h3141db200000002a0004702c0e0;  // horizontal
      8'd143: microcode = 108'h132814820000002a00047039600;  // column 1 v
      8'd144: microcode = 108'h32985b200000002a0004702f0e0;  // cross
      8'd145: microcode = 108'h22a05ae00000012d46e8103b000;  // 1/determinant, defect
      8'd146: microcode = 108'h83a40000057640227c05f01d400;  // extent u
      8'd147: microcode = 108'h83a400000438000a7c05f03d400;  // extent u
      8'd148: microcode = 108'h83ac0000057640227c05f01d800;  // extent v
      8'd149: microcode = 108'h83ac00000438000a7c05f03d800;  // extent v
      8'd150: microcode = 108'h32b84000036980227c00101b400;  // 1/density, seed
      8'd151: microcode = 108'h32b84000022bc10a7c00103b400;  // 1/density, seed
      8'd152: microcode = 108'h4220dba00000002a0004703be00;  // peak of the profile
      8'd153: microcode = 108'h52c05c00000000ad8b78103c200;  // 1/3 - d (1/4 ..)
      8'd154: microcode = 108'h32984b0e0000002a0004702e0e0;  // shear
      8'd155: microcode = 108'h2e80000007840ad83180037a00;  // below the largest ratio u
      8'd156: microcode = 108'h2e800000078402d83100037800;  // above the least ratio u
      8'd157: microcode = 108'h2ec00000078402d83300038000;  // above the least ratio v
      8'd158: microcode = 108'h2ec0000007840ad83380038200;  // below the largest ratio v
      8'd159: microcode = 108'h3121db200000002a000470300e0;  // conic c
      8'd160: microcode = 108'h28854820000002a0004703bc00;  // area
      8'd161: microcode = 108'h131418a000000060680470090e0;  // xx
      8'd162: microcode = 108'h1324192000000040680470090e0;  // xx
      8'd163: microcode = 108'h133419a000000040680470090e0;  // xx
      8'd164: microcode = 108'h1400000150784048680470290e0;  // xx
      8'd165: microcode = 108'h131419e0000000606804701a600;  // minor 0 2
      8'd166: microcode = 108'h131c19a0000001486804703a600;  // minor 0 2
      8'd167: microcode = 108'h132419e0000000606804701a800;  // minor 1 2
      8'd168: microcode = 108'h132c19a0000001486804703a800;  // minor 1 2
      8'd169: microcode = 108'h131c18e0000000606804701a000;  // yy, sharp
      8'd170: microcode = 108'h132c1960000000406804701a000;  // yy, sharp
      8'd171: microcode = 108'h133c19e0000000486804703a000;  // yy, sharp
      8'd172: microcode = 108'h72c840000078802a7c05f03d000;  // cut-off, 16 bits
      default: microcode = 108'h0;
    endcase
  endfunction

endpackage
