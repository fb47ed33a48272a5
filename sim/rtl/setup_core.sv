// A core of the setup unit: a register file and one pipeline, through which goes every sum of products of setup, one term a cycle.
//
//   registers | factors | choice, exponents | signs | product (2) | term | largest (6) | distance | shift (2) | sign | sum |
//   normalisation (3) | rounding | carry, write
//
// It is `sum_of_products`, `sum_below` and `SoftFloat::from_wide` of src/math/soft_float.rs, and all else in setup is written as such sums: a multiplication has one
// term, a fixed-point number a unit that is given, a table's interpolation two terms. Results are mantissas of 31 bits of which the last
// are 0, or 33 bits of the sum, from a place on that the slot says. So one aligner and one normaliser do for the whole of setup, and several cores side by
// side, which obey the same slots, for any speed.
//
// Terms are products of two factors of 31 bits; a plain one stands as high as its product with 2^31 would. So they are only ever moved right. What ought to be moved left
// is beyond every fixed-point number in use, and stays where it is, which is as far beyond.
//
// The unit of a sum is known once the exponent of its last term is; until then its terms wait three cycles, so that up to four can be aligned to the largest.
module setup_core (
    input logic clk,
    // Slots by stage: slots[i] was issued i cycles ago. Registers' addresses come with the first and the last.
    input logic [24*splatline_setup_pkg::SLOT_BITS-1:0] slots,
    input logic [7:0] a_place,
    input logic [7:0] b_place,
    input logic [7:0] result_place,
    // The slot's constant one and three cycles after its issue, and where a sum begins seventeen cycles after.
    input logic [50:0] constant1,
    input logic [50:0] constant3,
    input logic [63:0] start17,
    // Half of the last bit that the slot's result keeps, and the bits that it keeps.
    input logic [15:0] half21,
    input logic [16:0] kept21,
    // Records: written in beats, read in the round after.
    input logic load,
    input logic [3:0] load_place,
    input logic [splatline_setup_pkg::BEAT_BITS-1:0] load_beat,
    input logic side,
    // What `out` slots read, two cycles after.
    output logic signed [32:0] out_a,
    output logic signed [17:0] out_a_exponent,
    output logic signed [32:0] out_b,
    output logic signed [17:0] out_b_exponent
);
  localparam BITS = splatline_setup_pkg::SLOT_BITS;
  // Exponent of 0: below that of every term in use by more than a factor's, and twice it has a place.
  localparam signed [17:0] NOTHING = -18'sd49152;

  splatline_setup_pkg::slot_t slot0, slot1, slot2, slot3, slot4, slot8, slot9, slot10, slot11, slot12, slot16, slot17, slot19, slot20, slot21, slot22;
  assign slot0 = slots[0+:BITS];
  assign slot1 = slots[1*BITS+:BITS];
  assign slot2 = slots[2*BITS+:BITS];
  assign slot3 = slots[3*BITS+:BITS];
  assign slot4 = slots[4*BITS+:BITS];
  assign slot8 = slots[8*BITS+:BITS];
  assign slot9 = slots[9*BITS+:BITS];
  assign slot10 = slots[10*BITS+:BITS];
  assign slot11 = slots[11*BITS+:BITS];
  assign slot12 = slots[12*BITS+:BITS];
  assign slot16 = slots[16*BITS+:BITS];
  assign slot17 = slots[17*BITS+:BITS];
  assign slot19 = slots[19*BITS+:BITS];
  assign slot20 = slots[20*BITS+:BITS];
  assign slot21 = slots[21*BITS+:BITS];
  assign slot22 = slots[22*BITS+:BITS];

  // 0 to 2: registers, record, constant.
  (* ram_style = "block", no_rw_check *) logic [50:0] registers_a[0:255];
  (* ram_style = "block", no_rw_check *) logic [50:0] registers_b[0:255];
  logic [splatline_setup_pkg::BEAT_BITS-1:0] records[0:15];
  logic write23;
  logic [7:0] place23;
  logic [32:0] result23;
  logic signed [17:0] exponent23;
  logic [50:0] register_a1;
  logic [50:0] register_b1;
  logic [splatline_setup_pkg::BEAT_BITS-1:0] beat1;
  logic [43:0] item1;
  always_ff @(posedge clk) begin
    if (write23) begin
      registers_a[place23] <= {exponent23, result23};
      registers_b[place23] <= {exponent23, result23};
    end
    register_a1 <= registers_a[a_place];
    register_b1 <= registers_b[b_place];
    if (load) records[load_place] <= load_beat;
    beat1 <= records[{side, slot0.a[3:1]}];
  end
  assign item1 = slot1.a[0] ? beat1[87:44] : beat1[43:0];

  logic signed [32:0] a2, a3, b2, b3;
  logic signed [17:0] a_exponent2, b_exponent2, b_exponent3;
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
    {a_exponent2, a2} <= slot1.a_input ? {{6{item1[43]}}, item1[43:32], item1[31], item1[31:0]} : slot1.a_constant ? constant1 : register_a1;
    {b_exponent2, b2} <= slot1.b_constant ? constant1 : register_b1;
    {a3, b3, b_exponent3} <= {a2, b2, b_exponent2};
    entry3 <= splatline_tables::setup_entry(index2);
  end

  // 2: the left factor, and what the first factor gives the exponent. A reciprocal's is its negative but for the one that the slot's own part adds.
  logic signed [31:0] left2, left3, left4, right4;
  logic signed [17:0] first2, first3;
  always_comb begin
    left2 = a2[31:0];
    first2 = a_exponent2;
    case (slot2.lookup)
      2'd1: {left2, first2} = {10'd0, a2[21:0], ~a_exponent2};
      2'd2: {left2, first2} = {16'd0, even2 ? a2[22:7] : a2[23:8], a_exponent2 >>> 1};
      2'd3: first2 = 0;
      default: ;
    endcase
    if (slot2.power) left2 = {{5{a_exponent2[17]}}, a_exponent2, 9'd0};
    if (slot2.power || slot2.pick != 0) first2 = 0;
  end

  // 3: a plain term's value, a product's signs, the exponent.
  logic signed [32:0] value3, plain4, plain5;
  logic signed [17:0] second3, sum4, exponent5, exponent6, exponent7, exponent8, exponent9, exponent10, exponent11, exponent12, exponent13;
  logic chosen3;
  assign chosen3 = slot3.pick[1] ^ a3[32];
  always_comb begin
    value3 = a3;
    second3 = slot3.plain || slot3.lookup != 0 ? 18'sd0 : b_exponent3;
    if (slot3.entry) value3 = {1'b0, entry3[54:23]};
    else if (slot3.pick != 0) {second3, value3} = chosen3 ? constant3 : {b_exponent3, b3};
  end
  always_ff @(posedge clk) begin
    {left3, first3} <= {left2 ^ {32{slot2.negated}}, first2};
    left4 <= left3 + {31'd0, slot3.negated};
    // A table's entry is never negative, and its memory is slow.
    if (slot3.lookup != 0) right4 <= {9'd0, entry3[22:0]};
    else right4 <= b3[31:0];
    plain4 <= value3;
    // Of product and plain value one is 0.
    if (slot3.plain) right4 <= 0;
    else plain4 <= 0;
    sum4 <= first3 + second3;
    exponent5 <= sum4 + 18'(slot4.offset);
    plain5 <= plain4;
  end

  // 4 to 6: the product from parts of 17 bits and a sign: as many as a signed multiplier has.
  logic signed [35:0] high5, low5, cross5, crossed5;
  logic signed [46:0] high6;
  logic signed [35:0] cross6;
  logic [16:0] low6;
  always_ff @(posedge clk) begin
    high5 <= $signed(36'($signed(left4[31:17])) * 36'($signed(right4[31:17])));
    cross5 <= $signed(36'($signed(left4[31:17])) * 36'($signed({1'b0, right4[16:0]})));
    crossed5 <= $signed(36'($signed({1'b0, left4[16:0]})) * 36'($signed(right4[31:17])));
    low5 <= $signed(36'($signed({1'b0, left4[16:0]})) * 36'($signed({1'b0, right4[16:0]})));
    high6 <= {high5[29:0], low5[33:17]} | {plain5, 14'd0};
    cross6 <= cross5 + crossed5;
    low6 <= low5[16:0];
  end

  // 7 to 13: the term, and the sum's unit: the largest that its terms ask for, or the first one's.
  logic signed [63:0] term7, term8, term9, term10, term11, term12, term13;
  logic signed [17:0] asked8, unit9, unit10, unit11, unit12, unit13;
  assign asked8 = 18'(slot8.step) + (slot8.base == 2'd2 ? 18'sd0 : exponent8);
  always_ff @(posedge clk) begin
    term7 <= {high6 + 47'(cross6), low6};
    {exponent6, exponent7, exponent8} <= {exponent5, exponent6, exponent7};
    {term8, exponent9} <= {term7, exponent8};
    {term9, term10, term11, term12, term13} <= {term8, term9, term10, term11, term12};
    {exponent10, exponent11, exponent12, exponent13} <= {exponent9, exponent10, exponent11, exponent12};
    if (slot8.first || slot8.again || slot8.base == 0 && asked8 > unit9) unit9 <= asked8;
    {unit10, unit11, unit12} <= {unit9, unit10, unit11};
    // What the last of the sum's terms, right behind, made of the unit.
    unit13 <= slot12.last ? unit12 : slot11.last ? unit11 : slot10.last ? unit10 : unit9;
  end

  // 13 to 17: the term moved to the unit, by sixteens and by the rest; the last bit moved out rounds. From 63 on all bits are the sign.
  logic signed [18:0] shift13;
  logic [5:0] distance14;
  logic [3:0] distance15;
  logic signed [63:0] term14;
  logic signed [64:0] moved15, moved16;
  logic signed [63:0] aligned17;
  logic carry17;
  logic signed [17:0] unit14, unit15, unit16, unit17, unit18, unit19, unit20, unit21, exponent22;
  assign shift13 = $signed({unit13[17], unit13}) - $signed({exponent13[17], exponent13});
  always_ff @(posedge clk) begin
    term14 <= term13;
    distance14 <= shift13[18] ? 6'd0 : shift13[17:6] != 0 ? 6'd63 : shift13[5:0];
    moved15 <= $signed({term14, 1'b0}) >>> {distance14[5:4], 4'd0};
    distance15 <= distance14[3:0];
    moved16 <= moved15 >>> distance15;
    aligned17 <= moved16[64:1] ^ {64{slot16.subtracted}};
    carry17 <= (moved16[0] && !slot16.down) ^ slot16.subtracted;
    {unit14, unit15, unit16, unit17} <= {unit13, unit14, unit15, unit16};
  end

  // 17: the sum, whose start is 0 after its first term. A sum in two parts goes on in the coarser unit of the second.
  logic signed [63:0] so_far17, sum18;
  logic rounds17;
  generate
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
    {unit18, unit19, unit20, unit21} <= {unit17, unit18, unit19, unit20};
  end

  // 18 to 21: moved left until the leading bit stands below the sign, or as far as the slot says; 22: rounded; 23: carried.
  logic [64:0] sum19;
  logic [64:0] thirties19;
  logic [48:0] sixteens19;
  logic [40:0] moved20;
  logic [33:0] moved21, rounded22;
  logic [6:0] signs19;
  logic far19, middle19, near19, far20, middle20, near20;
  logic [2:0] rest20;
  logic [5:0] spare21;
  logic nothing22, carried22, over22;
  // Which bytes below the sign are nothing but signs; eight bits more for each of them that no other byte precedes.
  always_comb begin
    far19 = &signs19[3:0];
    middle19 = far19 ? &signs19[5:4] : &signs19[1:0];
    near19 = far19 ? (middle19 ? signs19[6] : signs19[4]) : (middle19 ? signs19[2] : signs19[0]);
    if (!slot19.normal) {far19, middle19, near19} = slot19.spare[5:3];
    thirties19 = far19 ? {sum19[32:0], 32'd0} : sum19;
    sixteens19 = middle19 ? thirties19[48:0] : thirties19[64:16];
    rest20 = slot20.spare[2:0];
    if (slot20.normal) begin
      rest20 = 3'd7;
      for (int i = 0; i < 7; i = i + 1) if (moved20[32+i] != moved20[39]) rest20 = 3'(6 - i);
    end
  end
  assign over22 = rounded22[33] && !rounded22[31] && rounded22[30:1] == 0;
  assign carried22 = slot22.normal && (rounded22[32] != rounded22[33] || over22);
  always_ff @(posedge clk) begin
    sum19 <= {sum18[63], sum18};
    for (int i = 0; i < 7; i = i + 1) signs19[i] <= sum18[55-8*i+:9] == {9{sum18[63-8*i]}};
    moved20 <= near19 ? sixteens19[40:0] : sixteens19[48:8];
    {far20, middle20, near20} <= {far19, middle19, near19};
    moved21 <= 34'((moved20 << rest20) >> 7);
    spare21 <= {far20, middle20, near20, rest20};
    rounded22 <= (moved21 + {18'd0, half21}) & {17'h1ffff, kept21};
    exponent22 <= unit21 + 18'sd32 - $signed({12'd0, spare21});
    nothing22 <= slot21.normal && moved21[31] == moved21[32];

    place23 <= result_place;
    write23 <= slot22.write;
    // What carries is a power of two.
    result23 <= {rounded22[33], carried22 ? rounded22[33] : rounded22[32], rounded22[31] | carried22, rounded22[30:1]};
    exponent23 <= exponent22 + $signed({17'd0, carried22});
    if (nothing22) exponent23 <= NOTHING;
  end
endmodule
