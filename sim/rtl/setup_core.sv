// A core of the setup unit: a register file and one pipeline, through which goes every sum of products of setup, one term a cycle.
//
//   registers | factors | table | magnitudes | product (2) | term | length | largest | unit (4) | distance | shift (2) | rounding | sum (2) |
//   length | shift | rounding | carry, write
//
// It is `sum_of_products`, `sum_below` and `SoftFloat::from_wide` of src/math/soft_float.rs, and all else in setup is written as such sums: a multiplication has one
// term, a fixed-point number a unit that is given, a table's interpolation two terms. Results are mantissas of 31 bits of which the last `drop`
// are 0, or 64 bits as they are. So one aligner and one normaliser do for the whole of setup, and several cores side by side, which obey the same slots, for any speed.
//
// The unit of a sum is known once the exponent of its last term is; until then its terms wait three cycles, so that up to four can be aligned to the largest.
module setup_core (
    input logic clk,
    // Slots by stage: slots[i] was issued i cycles ago. Registers' addresses come with the first and the last.
    input logic [24*splatline_setup_pkg::SLOT_BITS-1:0] slots,
    input logic [7:0] a_place,
    input logic [7:0] b_place,
    input logic [7:0] result_place,
    input logic [3:0] flags,
    // The slot's constant, one, four and seventeen cycles after its issue.
    input logic [81:0] constant1,
    input logic [81:0] constant3,
    input logic [63:0] constant17,
    // Records: written in beats, read in the round after.
    input logic load,
    input logic [3:0] load_place,
    input logic [splatline_setup_pkg::BEAT_BITS-1:0] load_beat,
    input logic side,
    // What `out` slots read, two cycles after.
    output logic signed [63:0] out_a,
    output logic signed [17:0] out_a_exponent,
    output logic signed [51:0] out_b,
    output logic signed [17:0] out_b_exponent
);
  localparam BITS = splatline_setup_pkg::SLOT_BITS;
  localparam signed [17:0] NOTHING = -18'sd65535;  // exponent of 0

  splatline_setup_pkg::slot_t slot0, slot1, slot2, slot3, slot6, slot8, slot9, slot10, slot11, slot12, slot16, slot17, slot21, slot22;
  assign slot0 = slots[0+:BITS];
  assign slot1 = slots[1*BITS+:BITS];
  assign slot2 = slots[2*BITS+:BITS];
  assign slot3 = slots[3*BITS+:BITS];
  assign slot6 = slots[6*BITS+:BITS];
  assign slot8 = slots[8*BITS+:BITS];
  assign slot9 = slots[9*BITS+:BITS];
  assign slot10 = slots[10*BITS+:BITS];
  assign slot11 = slots[11*BITS+:BITS];
  assign slot12 = slots[12*BITS+:BITS];
  assign slot16 = slots[16*BITS+:BITS];
  assign slot17 = slots[17*BITS+:BITS];
  assign slot21 = slots[21*BITS+:BITS];
  assign slot22 = slots[22*BITS+:BITS];

  // 0 to 2: registers, record, constant.
  (* ram_style = "block", no_rw_check *) logic [81:0] registers_a[0:255];
  (* ram_style = "block", no_rw_check *) logic [69:0] registers_b[0:255];
  logic [splatline_setup_pkg::BEAT_BITS-1:0] records[0:15];
  logic write23;
  logic [7:0] place23;
  logic signed [63:0] result23;
  logic signed [17:0] exponent23;
  logic [81:0] register_a1;
  logic [69:0] register_b1;
  logic [splatline_setup_pkg::BEAT_BITS-1:0] beat1;
  logic [43:0] item1;
  always_ff @(posedge clk) begin
    if (write23) begin
      registers_a[place23] <= {exponent23, result23};
      registers_b[place23] <= {exponent23, result23[51:0]};
    end
    register_a1 <= registers_a[a_place];
    register_b1 <= registers_b[b_place];
    if (load) records[load_place] <= load_beat;
    beat1 <= records[{side, slot0.a[3:1]}];
  end
  assign item1 = slot1.a[0] ? beat1[87:44] : beat1[43:0];
  // Axes are rounded down to the bits that they need.
  logic [31:0] kept1;
  assign kept1 = slot1.a >= 6 && slot1.a <= 14 ? 32'hffffffff << splatline_setup_pkg::AXIS_DROP : 32'hffffffff;

  logic signed [63:0] a2, a3;
  logic signed [51:0] b2, b3;
  logic signed [17:0] a_exponent2, a_exponent3, b_exponent2, b_exponent3;
  logic [54:0] entry3;
  logic even2;
  logic [8:0] index2;
  // A root's argument is halved where its exponent needs it to be even.
  assign even2 = a_exponent2[0];
  always_comb begin
    index2 = {1'b0, a2[29:22]};
    if (slot2.lookup == 2'd2) index2 = 9'd256 + {1'b0, even2 ? a2[30:23] : a2[31:24]};
    if (slot2.lookup == 2'd3) index2 = {4'b1000, a2[29:25]};
  end
  assign {out_a, out_a_exponent, out_b, out_b_exponent} = {a2, a_exponent2, b2, b_exponent2};
  always_ff @(posedge clk) begin
    {a_exponent2, a2} <= slot1.a_input ? {{6{item1[43]}}, item1[43:32], {32{item1[31]}}, item1[31:0] & kept1} : slot1.a_constant ? constant1 : register_a1;
    {b_exponent2, b2} <= slot1.b_constant ? {constant1[81:64], constant1[51:0]} : register_b1;
    {a3, a_exponent3, b3, b_exponent3} <= {a2, a_exponent2, b2, b_exponent2};
    entry3 <= splatline_tables::setup_entry(index2);
  end

  // 2: the left factor. 3: factors' magnitudes, or the plain term.
  logic signed [33:0] left2, left3, right3;
  logic looks_up3;
  always_comb begin
    left2 = a2[33:0];
    case (slot2.lookup)
      2'd1: left2 = {11'd0, a2[21:0], 1'b0};
      2'd2: left2 = {18'd0, even2 ? a2[22:7] : a2[23:8]};
      default: ;
    endcase
    if (slot2.power) left2 = {{16{a_exponent2[17]}}, a_exponent2} + 34'sd30;
  end
  logic signed [63:0] value3;
  logic signed [17:0] exponent3;
  logic chosen3;
  logic signed [17:0] half3;
  assign right3 = b3[33:0];
  assign looks_up3 = slot3.lookup != 0;
  assign chosen3 = slot3.pick == 2'd1 ? a3[63] : flags[slot3.flag];
  assign half3 = (a_exponent3 + 18'sd32) >>> 1;  // half the power of two above a root's argument
  always_comb begin
    value3 = slot3.entry ? {32'd0, entry3[54:23]} : a3;
    exponent3 = slot3.plain && !slot3.scaled ? a_exponent3 : a_exponent3 + b_exponent3;
    if (slot3.power) exponent3 = b_exponent3;
    case (slot3.lookup)
      2'd1: exponent3 = -18'sd60 - a_exponent3 - (slot3.entry ? 18'sd0 : 18'sd23);
      2'd2: exponent3 = half3 - (slot3.entry ? 18'sd24 : 18'sd40);
      2'd3: exponent3 = slot3.entry ? -18'sd32 : -18'sd46;
      default: ;
    endcase
    if (slot3.pick == 2'd1 && chosen3) begin
      value3 = constant3[63:0];
      exponent3 = constant3[81:64];
    end else if (slot3.pick == 2'd1 || slot3.pick == 2'd2 && !chosen3) begin
      value3 = {{12{b3[51]}}, b3};
      exponent3 = b_exponent3;
    end
  end

  logic [33:0] left4, right4;
  logic signed [63:0] plain4;
  logic [63:0] plain5, plain6, magnitude7;
  logic [67:0] product6;
  logic product_sign4, plain_sign4, sign4, sign5, sign6, negative7;
  logic negated4, is_plain4;
  logic signed [17:0] exponent4, exponent5, exponent6, exponent7, exponent8, exponent9, exponent10, exponent11, exponent12, exponent13;
  logic signed [17:0] second4, second5, second6, second7, second8;
  assign sign4 = (is_plain4 ? plain_sign4 : product_sign4) ^ negated4;
  always_ff @(posedge clk) begin
    left3 <= left2;
    left4 <= left3[33] ? -left3 : left3;
    // A table's entry is never negative, and its memory is slow.
    right4 <= looks_up3 ? {11'd0, entry3[22:0]} : right3[33] ? -right3 : right3;
    plain4 <= value3;
    product_sign4 <= left3[33] ^ (right3[33] && !looks_up3);
    plain_sign4 <= value3[63];
    negated4 <= slot3.negated;
    is_plain4 <= slot3.plain;
    {exponent4, second4} <= {exponent3, b_exponent3};
    plain5 <= plain_sign4 ? -plain4 : plain4;
    {sign5, exponent5, second5} <= {sign4, exponent4, second4};
    {plain6, sign6, exponent6, second6} <= {plain5, sign5, exponent5, second5};
  end
  multiply #(.LEFT(34), .RIGHT(34)) multiplier (.clk, .advance(1'b1), .left(left4), .right(right4), .product(product6));

  // 7 to 9: the term's length, the largest term so far.
  logic [63:0] magnitude8, magnitude9, magnitude10, magnitude11, magnitude12, magnitude13;
  logic negative8, negative9, negative10, negative11, negative12, negative13;
  logic [6:0] length8, length9, length10, length11, length12, length13;
  logic signed [17:0] top8, largest8, largest9, based8, based9, unit9, unit10, unit11, unit12, unit13;
  logic signed [17:0] step8, step9;
  assign step8 = {{11{slot8.step[6]}}, slot8.step};
  // The end of the term's format: of a mantissa's 31 bits, or of two.
  assign top8 = length8 == 0 ? -18'sd98304 : exponent8 + (slot8.plain ? 18'sd31 : 18'sd62);
  assign largest8 = slot8.first || top8 > largest9 ? top8 : largest9;
  // The unit is the largest term's but for a step, taken off in the next cycle, or what its first term says.
  assign unit9 = slot9.base != 0 ? based9 : largest9 - step9;
  always_comb begin
    based8 = second8;
    if (!slot8.first) based8 = unit9;
    else if (slot8.base == 2'd1) based8 = exponent8 + step8;
    else if (slot8.base == 2'd2) based8 = step8;
  end
  always_ff @(posedge clk) begin
    magnitude7 <= slot6.plain ? plain6 : product6[63:0];
    {negative7, exponent7, second7} <= {sign6, exponent6, second6};
    {magnitude8, negative8, exponent8, second8} <= {magnitude7, negative7, exponent7, second7};
    length8 <= splatline_math::length(magnitude7);
    {magnitude9, negative9, exponent9, length9} <= {magnitude8, negative8, exponent8, length8};
    {largest9, based9, step9} <= {largest8, based8, step8};
    {magnitude10, negative10, exponent10, length10, unit10} <= {magnitude9, negative9, exponent9, length9, unit9};
    {magnitude11, negative11, exponent11, length11, unit11} <= {magnitude10, negative10, exponent10, length10, unit10};
    {magnitude12, negative12, exponent12, length12, unit12} <= {magnitude11, negative11, exponent11, length11, unit11};
    {magnitude13, negative13, exponent13, length13} <= {magnitude12, negative12, exponent12, length12};
    // What the last of the sum's terms, right behind, made of the unit.
    unit13 <= slot12.last || slot12.base != 0 ? unit12 : slot11.last ? unit11 : slot10.last ? unit10 : unit9;
  end

  // 13 to 17: alignment, as in align.sv.
  logic signed [18:0] shift13;
  logic signed [19:0] left13;
  logic signed [64:0] value14;
  logic overflow14, overflow15, overflow16, negative14, negative15, negative16;
  logic [6:0] distance14;
  logic [3:0] distance15;
  logic signed [79:0] moved15;
  logic signed [64:0] moved16;
  logic signed [17:0] unit14, unit15, unit16, unit17, unit18, unit19, unit20, unit21, unit22;
  logic signed [63:0] aligned17;
  assign shift13 = $signed({unit13[17], unit13}) - $signed({exponent13[17], exponent13});
  assign left13 = 20'sd0 - $signed({shift13[18], shift13});
  always_ff @(posedge clk) begin
    value14 <= negative13 ? -$signed({1'b0, magnitude13}) : $signed({1'b0, magnitude13});
    overflow14 <= shift13 < 0 && length13 != 0 && left13 + $signed({13'd0, length13}) > 20'sd63;
    distance14 <= shift13 > 19'sd64 ? 7'd127 : shift13 < -19'sd63 ? 7'd0 : shift13[6:0] + 7'd63;
    negative14 <= negative13;
    {overflow15, negative15} <= {overflow14, negative14};
    moved15 <= 80'($signed({value14, 64'd0}) >>> {distance14[6:4], 4'd0});
    distance15 <= distance14[3:0];
    {overflow16, negative16} <= {overflow15, negative15};
    moved16 <= 65'(moved15 >>> distance15);
    if (overflow16) aligned17 <= {negative16, {63{!negative16}}};
    else aligned17 <= moved16[64:1] + $signed({63'd0, moved16[0] && !slot16.down});
    {unit14, unit15, unit16, unit17} <= {unit13, unit14, unit15, unit16};
  end

  // 17 to 19: the sum, then saturated.
  logic signed [67:0] sum18, base17;
  logic signed [63:0] sum19, sum20, sum21, sum22;
  assign base17 = slot17.first ? (slot17.addend ? {{4{constant17[63]}}, constant17} : 68'sd0) : sum18;
  always_ff @(posedge clk) begin
    sum18 <= slot17.subtracted ? base17 - {{4{aligned17[63]}}, aligned17} : base17 + {{4{aligned17[63]}}, aligned17};
    sum19 <= sum18[67:63] == {5{sum18[63]}} ? sum18[63:0] : {sum18[67], {63{!sum18[67]}}};
    {unit18, unit19} <= {unit17, unit18};
  end

  // 19 to 23: normalisation. The ones' complement of a negative power of two is a bit shorter than its magnitude; its mantissa carries then.
  logic [6:0] length20, length21, length22;
  logic [5:0] spare20;
  logic signed [32:0] moved21;
  logic signed [33:0] half21, rounded22, mask21;
  logic nothing21, nothing22;
  logic carried22;
  assign spare20 = 6'd63 - length20[5:0];
  assign half21 = 34'sd1 <<< slot21.drop;
  assign mask21 = -(34'sd2 <<< slot21.drop);
  // 2^31 or -2^31.
  assign carried22 = rounded22[32] != rounded22[33] || rounded22[33] && !rounded22[31] && rounded22[32:1] == 32'h80000000;
  always_ff @(posedge clk) begin
    {sum20, unit20} <= {sum19, unit19};
    length20 <= splatline_math::length(sum19[63] ? ~sum19 : sum19);
    {sum21, unit21, length21} <= {sum20, unit20, length20};
    moved21 <= 33'(64'(sum20 <<< spare20) >> 31);
    nothing21 <= sum20 == 0;
    {sum22, unit22, length22, nothing22} <= {sum21, unit21, length21, nothing21};
    rounded22 <= ({moved21[32], moved21} + half21) & mask21;

    place23 <= result_place;
    write23 <= slot22.write;
    result23 <= sum22;
    exponent23 <= unit22;
    if (slot22.normal) begin
      result23 <= carried22 ? {{32{rounded22[33]}}, rounded22[33:2]} : {{32{rounded22[33]}}, rounded22[32:1]};
      exponent23 <= unit22 + $signed({11'd0, length22}) - (carried22 ? 18'sd30 : 18'sd31);
      if (nothing22) {exponent23, result23} <= {NOTHING, 64'd0};
    end
  end
endmodule
