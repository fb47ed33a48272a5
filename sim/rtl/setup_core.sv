// A core of the setup unit: one pipeline, through which goes every sum of products of setup, one term a cycle. Its
// registers and tables stand in setup_memory.sv.
//
//   registers | factors | rest, exponents | signs, choice | entry | product (2) | term | largest (2) | distance |
//   shift (2) | sign | sum | normalisation (4) | rounding | carry, write
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
// The unit of a sum is known once the exponent of its last term is: of up to four terms, three cycles after the first
// one's. Meanwhile tables and multipliers have registers, and the term waits for the rest of the time.
module setup_core (
    input logic clk,
    // Slots by stage: slots[i] was issued i cycles ago.
    input logic [22*splatline_setup_pkg::SLOT_BITS-1:0] slots,
    // Registers that the slot reads, one cycle after its issue, and its result.
    input logic [50:0] register_a1,
    input logic [50:0] register_b1,
    output logic [50:0] result21,
    // What a table is asked for two cycles after, and its answer.
    output logic [8:0] index2,
    input logic [31:0] table4,
    // The slot's constant as first factor one cycle after its issue and as what is picked three cycles after, 0 where
    // it is neither; what is the same for all cores of the exponents, and of the right factor: the constant, or 2^31
    // beside a plain term. Where a sum begins, fourteen cycles after.
    input logic [50:0] constant1,
    input logic [32:0] picked3,
    input logic [17:0] offset3,
    input logic [32:0] right4,
    input logic [63:0] start14,
    // Half of the last bit that the slot's result keeps, and the bits that it keeps.
    input logic [15:0] half19,
    input logic [16:0] mask19,
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

  splatline_setup_pkg::slot_t slot0, slot2, slot3, slot4, slot5, slot7, slot8, slot9, slot13;
  splatline_setup_pkg::slot_t slot14, slot15, slot16, slot17, slot18, slot19, slot20;
  assign slot0 = slots[0+:BITS];
  assign slot2 = slots[2*BITS+:BITS];
  assign slot3 = slots[3*BITS+:BITS];
  assign slot4 = slots[4*BITS+:BITS];
  assign slot5 = slots[5*BITS+:BITS];
  assign slot7 = slots[7*BITS+:BITS];
  assign slot8 = slots[8*BITS+:BITS];
  assign slot9 = slots[9*BITS+:BITS];
  assign slot13 = slots[13*BITS+:BITS];
  assign slot14 = slots[14*BITS+:BITS];
  assign slot15 = slots[15*BITS+:BITS];
  assign slot16 = slots[16*BITS+:BITS];
  assign slot17 = slots[17*BITS+:BITS];
  assign slot18 = slots[18*BITS+:BITS];
  assign slot19 = slots[19*BITS+:BITS];
  assign slot20 = slots[20*BITS+:BITS];

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
  logic signed [32:0] left2, left3, picked3_or_left;
  logic [32:0] mask2;
  logic [17:0] power2;
  logic signed [17:0] first2, first3, second3, sum4;
  logic signed [17:0] exponent5, exponent6, exponent7, exponent8, exponent9, exponent10;
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

  // 3, 4: the factors. Their last registers have neither other readers nor a reset, so that they can be the
  // multipliers' own.
  logic signed [32:0] left4, b4, left5, right5;
  logic looks_up4;
  assign picked3_or_left = left3 | second_value3 | (chosen3 ? picked3 : 33'sd0);
  assign second3 = b_exponent3 | (!picks3 || chosen3 ? offset3 : 18'd0);
  always_ff @(posedge clk) begin
    left3 <= left2 ^ {33{slot2.negated}};
    if (slot2.power || slot2.pick != 0 || slot2.lookup == 2'd3) first3 <= -18'sd31;
    else first3 <= first2;
    left4 <= picked3_or_left + {32'd0, slot3.negated};
    b4 <= b3;
    looks_up4 <= slot3.lookup != 0;
    left5 <= left4;
    // A slot with a table has no other right factor.
    right5 <= b4 | right4 | {1'b0, table4 & {32{looks_up4}}};
    // One addition with a carry.
    sum4 <= 18'($signed({first3, 1'b1} + {second3, even3}) >>> 1);
  end

  // 5 to 7: the product from parts of 17 bits and a sign: as many as a signed multiplier has.
  logic signed [35:0] high6, low6, cross6, crossed6;
  logic signed [46:0] high7;
  logic signed [35:0] cross7;
  logic [16:0] low7;
  always_ff @(posedge clk) begin
    high6 <= $signed(36'($signed(left5[32:17])) * 36'($signed(right5[32:17])));
    cross6 <= $signed(36'($signed(left5[32:17])) * 36'($signed({1'b0, right5[16:0]})));
    crossed6 <= $signed(36'($signed({1'b0, left5[16:0]})) * 36'($signed(right5[32:17])));
    low6 <= $signed(36'($signed({1'b0, left5[16:0]})) * 36'($signed({1'b0, right5[16:0]})));
    high7 <= {high6[29:0], low6[33:17]};
    cross7 <= cross6 + crossed6;
    low7 <= low6[16:0];
  end

  // 5 to 10: the term, and the sum's unit: the largest that its terms ask for, or the first one's. A term asks before
  // its product is there, so that only what comes behind it in its sum makes it wait.
  logic signed [63:0] term8, term9, term10;
  logic signed [17:0] candidate5, unit6, unit7, unit8, unit9, unit10;
  always_ff @(posedge clk) begin
    term8 <= {high7 + 47'(cross7), low7};
    {term9, term10} <= {term8, term9};
    candidate5 <= 18'(slot4.step) + (slot4.base == 2'd2 ? 18'sd0 : sum4);
    {exponent5, exponent6, exponent7, exponent8, exponent9, exponent10} <= {sum4, exponent5, exponent6, exponent7, exponent8, exponent9};
    if (slot5.first || slot5.again || slot5.base == 0 && candidate5 > unit6) unit6 <= candidate5;
    {unit7, unit8, unit9} <= {unit6, unit7, unit8};
    // What the last of the sum's terms, right behind, made of the unit.
    unit10 <= slot9.last ? unit9 : slot8.last ? unit8 : slot7.last ? unit7 : unit6;
  end

  // 10 to 14: the term moved to the unit, by sixteens, fours and ones; the last bit moved out rounds. From 63 on all
  // bits are the sign.
  logic signed [18:0] shift10;
  logic [5:0] distance11;
  logic [3:0] distance12;
  logic [1:0] distance13;
  logic signed [63:0] term11;
  logic signed [64:0] moved12, moved13, moved14;
  logic signed [63:0] aligned14;
  logic carry14;
  logic signed [17:0] unit11, unit12, unit13, unit14, unit15, unit16, unit17, unit18, unit19, exponent20;
  assign shift10 = $signed({unit10[17], unit10}) - $signed({exponent10[17], exponent10});
  assign moved14 = moved13 >>> distance13;
  always_ff @(posedge clk) begin
    term11 <= term10;
    distance11 <= shift10[18] ? 6'd0 : shift10[17:6] != 0 ? 6'd63 : shift10[5:0];
    moved12 <= $signed({term11, 1'b0}) >>> {distance11[5:4], 4'd0};
    distance12 <= distance11[3:0];
    moved13 <= moved12 >>> {distance12[3:2], 2'd0};
    distance13 <= distance12[1:0];
    aligned14 <= moved14[64:1] ^ {64{slot13.subtracted}};
    carry14 <= (moved14[0] && !slot13.down) ^ slot13.subtracted;
    {unit11, unit12, unit13, unit14} <= {unit10, unit11, unit12, unit13};
  end

  // 14: the sum, whose start is 0 after its first term. A sum in two parts goes on in the coarser unit of the second.
  logic signed [63:0] so_far14, sum15;
  logic rounds14;
  // What is left of a sum above and below a long word.
  logic signed [17:0] around15;
  generate
    if (FAINT > 0) begin : gen_long
      assign around15 = 18'({sum15[FAINT-1:0] != 0, sum15[63:FAINT+33]});
    end else begin : gen_short
      assign around15 = 0;
    end
    if (splatline_setup_pkg::LOW > 0) begin : gen_parts
      assign so_far14 = slot14.first ? 64'sd0 : slot14.again ? sum15 >>> splatline_setup_pkg::LOW : sum15;
      assign rounds14 = slot14.again && sum15[splatline_setup_pkg::LOW-1];
    end else begin : gen_one_part
      assign so_far14 = slot14.first ? 64'sd0 : sum15;
      assign rounds14 = 0;
    end
  endgenerate
  always_ff @(posedge clk) begin
    sum15 <= 64'(65'({so_far14 | start14, 1'b1} + {aligned14, carry14 || rounds14}) >> 1);
    {unit15, unit17, unit18, unit19} <= {unit14, unit16, unit17, unit18};
    unit16 <= FAINT > 0 && slot15.extended ? around15 : unit15;
  end

  // 15 to 19: moved left until the leading bit stands below the sign, or as far as the slot says, by sixteens, fours
  // and ones; 20: rounded; 21: carried.
  logic [64:0] sum16;
  logic [64:0] thirties16;
  logic [48:0] sixteens17;
  logic [36:0] fours18;
  logic [33:0] moved19, rounded20;
  logic [2:0] signs16;
  logic far16, middle16;
  logic [1:0] fours17, ones18;
  logic [1:0] far_middle17;
  logic [3:0] spare18;
  logic [5:0] spare19;
  logic nothing20, carried20, over20;
  // How many parts below the sign are nothing but signs, from the first one on.
  function automatic logic [1:0] leading(input logic [2:0] signs);
    leading = {signs[0] && signs[1], signs[0] && (!signs[1] || signs[2])};
  endfunction

  always_comb begin
    far16 = &signs16[1:0];
    middle16 = far16 ? signs16[2] : signs16[0];
    if (!slot16.normal) {far16, middle16} = slot16.spare[5:4];
    thirties16 = far16 ? {sum16[32:0], 32'd0} : sum16;
    fours17 = leading({sixteens17[39:35] == {5{sixteens17[39]}}, sixteens17[43:39] == {5{sixteens17[43]}}, sixteens17[47:43] == {5{sixteens17[47]}}});
    if (!slot17.normal) fours17 = slot17.spare[3:2];
    ones18 = leading({fours18[32] == fours18[35], fours18[33] == fours18[35], fours18[34] == fours18[35]});
    if (!slot18.normal) ones18 = slot18.spare[1:0];
  end
  assign over20 = rounded20[33] && !rounded20[31] && rounded20[30:1] == 0;
  assign carried20 = slot20.normal && (rounded20[32] != rounded20[33] || over20);
  always_ff @(posedge clk) begin
    sum16 <= {sum15[63], sum15};
    for (int i = 0; i < 3; i = i + 1) signs16[i] <= sum15[47-16*i+:17] == {17{sum15[63-16*i]}};
    sixteens17 <= middle16 ? thirties16[48:0] : thirties16[64:16];
    far_middle17 <= {far16, middle16};
    fours18 <= 37'((sixteens17 << {fours17, 2'd0}) >> 12);
    spare18 <= {far_middle17, fours17};
    moved19 <= 34'((fours18 << ones18) >> 3);
    spare19 <= {spare18, ones18};
    rounded20 <= (moved19 + {18'd0, half19}) & {17'h1ffff, mask19};
    // 32 bits to the left change nothing.
    exponent20 <= unit19 - 18'($signed({!spare19[5], spare19[4:0]}));
    nothing20 <= slot19.normal && moved19[31] == moved19[32];

    // What carries is a power of two.
    result21[32:31] <= {rounded20[33], carried20 ? rounded20[33] : rounded20[32]};
    result21[30:0] <= {rounded20[31] | carried20, rounded20[30:1]};
    result21[50:33] <= exponent20 + $signed({17'd0, carried20});
    if (nothing20) result21[50:33] <= NOTHING;
  end
endmodule
