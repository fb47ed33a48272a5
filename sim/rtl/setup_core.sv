// A core of the setup unit: one pipeline, through which goes every sum of products of setup, one term a cycle. Its
// registers and tables stand in setup_memory.sv.
//
//   registers | factors | rest, exponents | signs, choice | product (2) | term | largest (6) | distance | shift (2) |
//   sign | sum | normalisation (4) | rounding | carry, write
//
// It is `sum_of_products`, `sum_below` and `SoftFloat::from_wide` of src/math/soft_float.rs, and all else in setup is
// written as such sums: a multiplication has one term, a fixed-point number a unit that is given, a table's
// interpolation two terms. Results are mantissas of 31 bits of which the last are 0, or 33 bits of the sum, from a
// place on that the slot says. So one aligner and one normaliser do for the whole of setup, and several cores side by
// side, which obey the same slots, for any speed.
//
// Terms are products of two factors of 31 bits; a plain one stands as high as its product with 2^31 would. So they are
// only ever moved right. What ought to be moved left is beyond every fixed-point number in use, and stays where it is,
// which is as far beyond.
//
// The unit of a sum is known once the exponent of its last term is; until then its terms wait three cycles, so that up
// to four can be aligned to the largest.
module setup_core (
    input logic clk,
    // Slots by stage: slots[i] was issued i cycles ago.
    input logic [25*splatline_setup_pkg::SLOT_BITS-1:0] slots,
    // Registers that the slot reads, one cycle after its issue, and its result.
    input logic [50:0] register_a1,
    input logic [50:0] register_b1,
    output logic [50:0] result24,
    // What a table is asked for two cycles after, and its answer.
    output logic [8:0] index2,
    input logic [31:0] table3,
    // The slot's constant as first factor one cycle after its issue and as what is picked three cycles after, 0 where
    // it is neither; the right factor's share that is the same for all cores: the constant, or 2^31 beside a plain
    // term, with what the slot adds to the exponents. Where a sum begins, seventeen cycles after.
    input logic [50:0] constant1,
    input logic [32:0] picked3,
    input logic [50:0] right3,
    input logic [63:0] start17,
    // Half of the last bit that the slot's result keeps, and the bits that it keeps.
    input logic [15:0] half22,
    input logic [16:0] mask22,
    // Records: written in beats, read in the round after.
    input logic load,
    input logic [3:0] load_place,
    input logic [splatline_setup_pkg::BEAT_BITS-1:0] load_beat,
    input logic side,
    // What `out` slots read, two cycles after.
    output logic [50:0] out2
);
  localparam BITS = splatline_setup_pkg::SLOT_BITS;
  // Exponent of 0: below that of every term in use by more than a factor's, and twice it has a place.
  localparam signed [17:0] NOTHING = -18'sd49152;
  localparam FAINT = splatline_setup_pkg::FAINT;

  splatline_setup_pkg::slot_t slot0, slot1, slot2, slot3, slot4, slot7, slot8, slot9, slot10, slot11, slot12;
  splatline_setup_pkg::slot_t slot16, slot17, slot18, slot19, slot20, slot21, slot22, slot23;
  assign slot0 = slots[0+:BITS];
  assign slot1 = slots[1*BITS+:BITS];
  assign slot2 = slots[2*BITS+:BITS];
  assign slot3 = slots[3*BITS+:BITS];
  assign slot4 = slots[4*BITS+:BITS];
  assign slot7 = slots[7*BITS+:BITS];
  assign slot8 = slots[8*BITS+:BITS];
  assign slot9 = slots[9*BITS+:BITS];
  assign slot10 = slots[10*BITS+:BITS];
  assign slot11 = slots[11*BITS+:BITS];
  assign slot12 = slots[12*BITS+:BITS];
  assign slot16 = slots[16*BITS+:BITS];
  assign slot17 = slots[17*BITS+:BITS];
  assign slot18 = slots[18*BITS+:BITS];
  assign slot19 = slots[19*BITS+:BITS];
  assign slot20 = slots[20*BITS+:BITS];
  assign slot21 = slots[21*BITS+:BITS];
  assign slot22 = slots[22*BITS+:BITS];
  assign slot23 = slots[23*BITS+:BITS];

  // 0 to 2: registers, record, constant. What a slot does not use is 0, so that the sources need no choice, only an or.
  logic [splatline_setup_pkg::BEAT_BITS-1:0] records[0:15];
  logic [splatline_setup_pkg::BEAT_BITS-1:0] beat0;
  logic [43:0] even_item1, odd_item1, item1;
  assign beat0 = records[{side, slot0.a[3:1]}];
  assign item1 = even_item1 | odd_item1;
  always_ff @(posedge clk) begin
    if (load) records[load_place] <= load_beat;
    even_item1 <= slot0.a_input && !slot0.a[0] ? beat0[43:0] : 44'd0;
    odd_item1 <= slot0.a_input && slot0.a[0] ? beat0[87:44] : 44'd0;
  end

  logic signed [32:0] a2, b2, b3, second_value3;
  logic signed [17:0] a_exponent2, b_exponent2, b_exponent3;
  logic even2, even3, chosen2, chosen3, picks3;
  // A root's argument is halved where its exponent needs it to be even.
  assign even2 = a_exponent2[0];
  always_comb begin
    index2 = {1'b0, a2[29:22]};
    if (slot2.lookup == 2'd2) index2 = 9'd256 + {1'b0, even2 ? a2[30:23] : a2[31:24]};
    if (slot2.lookup == 2'd3) index2 = {4'b1000, a2[29:25]};
  end
  assign out2 = {b2, b_exponent2};
  // Does the sign pick the constant?
  assign picks3 = slot3.pick != 0;
  assign chosen2 = slot2.pick != 0 && (slot2.pick[1] ^ a2[32]);
  always_ff @(posedge clk) begin
    {a_exponent2, a2} <= {{6{item1[43]}}, item1[43:32], item1[31], item1[31:0]} | constant1 | register_a1;
    {b_exponent2, b2} <= register_b1;
    // What is picked is a left factor, and what leaves is none.
    b3 <= slot2.pick != 0 || slot2.out ? 33'sd0 : b2;
    second_value3 <= slot2.pick != 0 && !chosen2 ? b2 : 33'sd0;
    b_exponent3 <= chosen2 || slot2.out ? 18'sd0 : b_exponent2;
    chosen3 <= chosen2;
    even3 <= even2 && slot2.lookup == 2'd2 && !slot2.entry;
  end

  // 2: the left factor: the first one, or of a table's argument the rest, whose place the slot's own exponent knows;
  // beside an entry 2^31. What the first factor gives the exponent: a reciprocal's is its negative but for the one that
  // the slot's own part adds; where it counts for nothing, -31.
  logic signed [32:0] left2, left3, picked3_or_left, left4, right4;
  logic [32:0] mask2;
  logic [17:0] power2;
  logic signed [17:0] first2, first3, second3, sum4;
  logic signed [17:0] exponent5, exponent6, exponent7, exponent8, exponent9, exponent10, exponent11, exponent12, exponent13;
  always_comb begin
    mask2 = 33'h1ffffffff;
    first2 = a_exponent2;
    case (slot2.lookup)
      2'd1: {mask2, first2} = {33'h3fffff, ~a_exponent2};
      2'd2: {mask2, first2} = {even2 ? 33'h7fff80 : 33'hffff00, a_exponent2 >>> 1};
      default: ;
    endcase
    if (slot2.power || slot2.pick != 0 || slot2.entry) mask2 = 0;
    power2 = slot2.power ? a_exponent2 : 18'd0;
    left2 = (a2 & mask2) | {{6{power2[17]}}, power2, 9'd0};
    left2[31] = left2[31] | slot2.entry;
  end

  // 3: the factors.
  assign picked3_or_left = left3 | second_value3 | (chosen3 ? picked3 : 33'sd0);
  assign second3 = b_exponent3 | (!picks3 || chosen3 ? right3[50:33] : 18'd0);
  always_ff @(posedge clk) begin
    left3 <= left2 ^ {33{slot2.negated}};
    if (slot2.power || slot2.pick != 0 || slot2.lookup == 2'd3) first3 <= -18'sd31;
    else first3 <= first2;
    left4 <= picked3_or_left + {32'd0, slot3.negated};
    if (slot3.lookup != 0) right4 <= {1'b0, table3};
    else right4 <= b3 | right3[32:0];
    // One addition with a carry.
    sum4 <= 18'($signed({first3, 1'b1} + {second3, even3}) >>> 1);
    exponent5 <= sum4;
  end

  // 4 to 6: the product from parts of 17 bits and a sign: as many as a signed multiplier has.
  logic signed [35:0] high5, low5, cross5, crossed5;
  logic signed [46:0] high6;
  logic signed [35:0] cross6;
  logic [16:0] low6;
  always_ff @(posedge clk) begin
    high5 <= $signed(36'($signed(left4[32:17])) * 36'($signed(right4[32:17])));
    cross5 <= $signed(36'($signed(left4[32:17])) * 36'($signed({1'b0, right4[16:0]})));
    crossed5 <= $signed(36'($signed({1'b0, left4[16:0]})) * 36'($signed(right4[32:17])));
    low5 <= $signed(36'($signed({1'b0, left4[16:0]})) * 36'($signed({1'b0, right4[16:0]})));
    high6 <= {high5[29:0], low5[33:17]};
    cross6 <= cross5 + crossed5;
    low6 <= low5[16:0];
  end

  // 7 to 13: the term, and the sum's unit: the largest that its terms ask for, or the first one's.
  logic signed [63:0] term7, term8, term9, term10, term11, term12, term13;
  logic signed [17:0] candidate8, unit9, unit10, unit11, unit12, unit13;
  always_ff @(posedge clk) begin
    term7 <= {high6 + 47'(cross6), low6};
    {exponent6, exponent7, exponent8} <= {exponent5, exponent6, exponent7};
    candidate8 <= 18'(slot7.step) + (slot7.base == 2'd2 ? 18'sd0 : exponent7);
    {term8, exponent9} <= {term7, exponent8};
    {term9, term10, term11, term12, term13} <= {term8, term9, term10, term11, term12};
    {exponent10, exponent11, exponent12, exponent13} <= {exponent9, exponent10, exponent11, exponent12};
    if (slot8.first || slot8.again || slot8.base == 0 && candidate8 > unit9) unit9 <= candidate8;
    {unit10, unit11, unit12} <= {unit9, unit10, unit11};
    // What the last of the sum's terms, right behind, made of the unit.
    unit13 <= slot12.last ? unit12 : slot11.last ? unit11 : slot10.last ? unit10 : unit9;
  end

  // 13 to 17: the term moved to the unit, by sixteens, fours and ones; the last bit moved out rounds. From 63 on all
  // bits are the sign.
  logic signed [18:0] shift13;
  logic [5:0] distance14;
  logic [3:0] distance15;
  logic [1:0] distance16;
  logic signed [63:0] term14;
  logic signed [64:0] moved15, moved16, moved17;
  logic signed [63:0] aligned17;
  logic carry17;
  logic signed [17:0] unit14, unit15, unit16, unit17, unit18, unit19, unit20, unit21, unit22, exponent23;
  assign shift13 = $signed({unit13[17], unit13}) - $signed({exponent13[17], exponent13});
  assign moved17 = moved16 >>> distance16;
  always_ff @(posedge clk) begin
    term14 <= term13;
    distance14 <= shift13[18] ? 6'd0 : shift13[17:6] != 0 ? 6'd63 : shift13[5:0];
    moved15 <= $signed({term14, 1'b0}) >>> {distance14[5:4], 4'd0};
    distance15 <= distance14[3:0];
    moved16 <= moved15 >>> {distance15[3:2], 2'd0};
    distance16 <= distance15[1:0];
    aligned17 <= moved17[64:1] ^ {64{slot16.subtracted}};
    carry17 <= (moved17[0] && !slot16.down) ^ slot16.subtracted;
    {unit14, unit15, unit16, unit17} <= {unit13, unit14, unit15, unit16};
  end

  // 17: the sum, whose start is 0 after its first term. A sum in two parts goes on in the coarser unit of the second.
  logic signed [63:0] so_far17, sum18;
  logic rounds17;
  // What is left of a sum above and below a long word.
  logic signed [17:0] around18;
  generate
    if (FAINT > 0) begin : gen_long
      assign around18 = 18'({sum18[FAINT-1:0] != 0, sum18[63:FAINT+33]});
    end else begin : gen_short
      assign around18 = 0;
    end
    if (splatline_setup_pkg::LOW > 0) begin : gen_parts
      assign so_far17 = slot17.first ? 64'sd0 : slot17.again ? sum18 >>> splatline_setup_pkg::LOW : sum18;
      assign rounds17 = slot17.again && sum18[splatline_setup_pkg::LOW-1];
    end else begin : gen_one_part
      assign so_far17 = slot17.first ? 64'sd0 : sum18;
      assign rounds17 = 0;
    end
  endgenerate
  always_ff @(posedge clk) begin
    sum18 <= 64'(65'({so_far17 | start17, 1'b1} + {aligned17, carry17 || rounds17}) >> 1);
    {unit18, unit20, unit21, unit22} <= {unit17, unit19, unit20, unit21};
    unit19 <= FAINT > 0 && slot18.extended ? around18 : unit18;
  end

  // 18 to 22: moved left until the leading bit stands below the sign, or as far as the slot says, by sixteens, fours
  // and ones; 23: rounded; 24: carried.
  logic [64:0] sum19;
  logic [64:0] thirties19;
  logic [48:0] sixteens20;
  logic [36:0] fours21;
  logic [33:0] moved22, rounded23;
  logic [2:0] signs19;
  logic far19, middle19;
  logic [1:0] fours20, ones21;
  logic [1:0] far_middle20;
  logic [3:0] spare21;
  logic [5:0] spare22;
  logic nothing23, carried23, over23;
  // How many parts below the sign are nothing but signs, from the first one on.
  function automatic logic [1:0] leading(input logic [2:0] signs);
    leading = {signs[0] && signs[1], signs[0] && (!signs[1] || signs[2])};
  endfunction

  always_comb begin
    far19 = &signs19[1:0];
    middle19 = far19 ? signs19[2] : signs19[0];
    if (!slot19.normal) {far19, middle19} = slot19.spare[5:4];
    thirties19 = far19 ? {sum19[32:0], 32'd0} : sum19;
    fours20 = leading({sixteens20[39:35] == {5{sixteens20[39]}}, sixteens20[43:39] == {5{sixteens20[43]}}, sixteens20[47:43] == {5{sixteens20[47]}}});
    if (!slot20.normal) fours20 = slot20.spare[3:2];
    ones21 = leading({fours21[32] == fours21[35], fours21[33] == fours21[35], fours21[34] == fours21[35]});
    if (!slot21.normal) ones21 = slot21.spare[1:0];
  end
  assign over23 = rounded23[33] && !rounded23[31] && rounded23[30:1] == 0;
  assign carried23 = slot23.normal && (rounded23[32] != rounded23[33] || over23);
  always_ff @(posedge clk) begin
    sum19 <= {sum18[63], sum18};
    for (int i = 0; i < 3; i = i + 1) signs19[i] <= sum18[47-16*i+:17] == {17{sum18[63-16*i]}};
    sixteens20 <= middle19 ? thirties19[48:0] : thirties19[64:16];
    far_middle20 <= {far19, middle19};
    fours21 <= 37'((sixteens20 << {fours20, 2'd0}) >> 12);
    spare21 <= {far_middle20, fours20};
    moved22 <= 34'((fours21 << ones21) >> 3);
    spare22 <= {spare21, ones21};
    rounded23 <= (moved22 + {18'd0, half22}) & {17'h1ffff, mask22};
    // 32 bits to the left change nothing.
    exponent23 <= unit22 - 18'($signed({!spare22[5], spare22[4:0]}));
    nothing23 <= slot22.normal && moved22[31] == moved22[32];

    // What carries is a power of two.
    result24[32:31] <= {rounded23[33], carried23 ? rounded23[33] : rounded23[32]};
    result24[30:0] <= {rounded23[31] | carried23, rounded23[30:1]};
    result24[50:33] <= exponent23 + $signed({17'd0, carried23});
    if (nothing23) result24[50:33] <= NOTHING;
  end
endmodule
