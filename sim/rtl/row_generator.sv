// From splats to runs of pixels: one row of a splat in INTERVAL cycles, 1 or 2 (`next_row` and `next_block` of
// src/raster/spans.rs). With 2, which is as fast as one lane needs it, rows are issued in every other cycle since the
// reset, and both products of dx and both alignments are one circuit each (row_seed.sv).
//
// Down the rows, xc and C dy^2 are differenced; then 32 stages compute the row's span by the root table and the lanes'
// seed by two multiplications. The window must lie within one block of columns, so that a row is one run, and begin
// with a block's first column and row, so that a run begins with its seed. A row without pixels travels as a bubble,
// and so does a splat without rows, so that cycles depend on the number of rows and on the lengths of the runs alone.
//
// Stages never stand still. A row is only issued if the queue behind the stages has a place for it (`slot_valid`: a
// row, with or without a run), so that nothing is stopped half way. A name's number is the stage: 0 while the row is
// being issued.
module row_generator #(
    parameter LANE_BITS = 0,  // of a row's number, which say the lane that it goes to
    parameter INTERVAL = 1,
    parameter WIDE_MULTIPLIERS = 4  // of a product of two wide factors: 4, or 3 (multiply_three.sv)
) (
    input logic clk,
    input logic rst,
    input logic splat_valid,
    output logic splat_ready,
    input splatline_pkg::start_t start,
    input splatline_pkg::shape_t shape,
    output logic slot_valid,
    input logic slot_ready,
    output logic slot_has_run,
    // What will be said of the slot in the next cycle: whether it has a run, and of its row the lane's bits (above them
    // 0).
    output logic next_has_run,
    output logic [splatline_pkg::TILE_ROW_BITS-1:0] next_lane,
    output splatline_pkg::run_t run,
    output splatline_pkg::paint_t paint,
    output logic idle
);
  localparam M = splatline_pkg::MANTISSA;
  localparam E = splatline_pkg::EXPONENT;
  localparam RADIAL = splatline_pkg::RADIAL;
  localparam ROW_BITS = splatline_pkg::TILE_ROW_BITS;
  localparam COLUMN_BITS = splatline_pkg::TILE_COLUMN_BITS;
  localparam VERTICAL = splatline_pkg::VERTICAL;
  // Bits of xc and of C dy^2; fraction bits of xc, where its steps are small and where they are large.
  localparam CENTRE = $bits(start.centre);
  localparam ROW = $bits(start.vertical);
  localparam FINE = splatline_pkg::SUBPIXEL + 8;
  localparam COARSE = splatline_pkg::SUBPIXEL - 2;
  localparam [CENTRE:0] COARSE_REST = ((CENTRE + 1)'(1) << COARSE) - 1'b1;
  localparam THREE = WIDE_MULTIPLIERS == 3 && M > 22;
  // Is A there a cycle before it is multiplied?
  localparam LATE = INTERVAL == 2 || THREE ? 1 : 0;
  localparam STAGES = 32;
  // Rows from issue to the lanes' queues: twice the stages, so that the queue never runs dry while places come back.
  localparam PLACES = 64;

  // The splat whose rows are being issued: the row, and what is differenced down the rows.
  logic busy, place, due, issue, none, some0;
  logic [ROW_BITS-1:0] row0;
  logic signed [CENTRE-1:0] centre0, shear0;
  logic signed [ROW-1:0] vertical0, first0, second0;
  splatline_pkg::shape_t shape0;
  row_counter counter (.clk, .rst, .splat_valid, .splat_ready, .first(start.row), .rows(start.rows), .place(place && due), .busy, .issue, .row(row0), .some(some0));
  // With an interval of 2 rows are issued while `phase` is 0, so that it is the last bit of a stage's number when a row
  // is there.
  logic phase;
  always_ff @(posedge clk) begin
    phase <= !rst && !phase;
    due <= INTERVAL == 1 || rst || phase;
  end
  always_ff @(posedge clk) begin
    if (splat_ready) begin
      {centre0, shear0, vertical0, first0, second0} <= {start.centre, start.shear, start.vertical, start.first, start.second};
      shape0 <= shape;
    end else if (issue) begin
      centre0 <= centre0 + shear0;
      vertical0 <= vertical0 + first0;
      first0 <= first0 + second0;
    end
  end

  // Slots, and those of them that have a run as far as is known.
  logic [STAGES:1] slot;
  logic [STAGES:1] open;
  logic positive1, holds20;
  always_ff @(posedge clk) begin
    if (rst) begin
      slot <= 0;
      open <= 0;
    end else begin
      slot <= {slot[STAGES-1:1], issue};
      open <= {open[STAGES-1:21], open[20] && holds20, open[19:2], open[1] && positive1, issue && some0};
    end
  end

  // Stage 1: the row; what is left of the cut-off, Q.vertical.
  logic signed [CENTRE-1:0] centre1;
  logic signed [ROW-1:0] vertical1, rest1;
  logic coarse1, coarse14, coarse15, coarse16, coarse19, coarse20;
  logic [ROW_BITS-1:0] row1;
  logic [M-1:0] squared_width1, squared_width2;
  logic [RADIAL+4:0] cutoff1;
  splatline_pkg::paint_t paint1;
  logic [15:0] start_column1, end_column1;
  logic squared_width_odd1;
  logic signed [E-1:0] squared_width_power1, squared_width_power8;
  logic [5:0] drop_dx1, drop_dx17, drop_dx20;
  logic [M-1:0] horizontal1, horizontal;
  logic signed [E-1:0] drop_first1, drop_first, drop_first22, drop_first24, drop_radial23, drop_radial27;
  logic [31:0] second1, unit1, unit28, balance1, balance2;
  always_ff @(posedge clk) begin
    row1 <= row0;
    centre1 <= centre0;
    vertical1 <= vertical0;
    rest1 <= $signed({1'b0, shape0.reach}) - vertical0;
    coarse1 <= shape0.coarse;
    squared_width1 <= shape0.squared_width;
    squared_width_odd1 <= shape0.squared_width_odd;
    squared_width_power1 <= shape0.squared_width_power;
    cutoff1 <= shape0.cutoff;
    paint1 <= shape0.paint;
    {start_column1, end_column1} <= {shape0.start_column, shape0.end_column};
    drop_dx1 <= shape0.drop_dx;
    horizontal1 <= shape0.horizontal;
    drop_first1 <= shape0.drop_first;
    second1 <= shape0.second;
    unit1 <= shape0.unit;
    balance1 <= shape0.balance;
  end
  assign positive1 = !rest1[ROW-1] && rest1 != 0;
  delay #(.BITS(E), .STAGES(7)) hold_power (.clk, .rst, .advance(1'b1), .in(squared_width_power1), .out(squared_width_power8));

  // Stage 4: the squared half-width, Q.24 before the exponent, from factors that multipliers hold in registers of their
  // own. Stage 6: brought to [1/4, 1) by an even shift.
  logic [29:0] doubled1, doubled2;
  logic [M+29:0] product4;
  logic [63:0] squared4, squared5, normal5;
  logic [1:0] sixteenth4, sixteens4, sixteens5, pair5;
  logic [2:0] pairs5;
  logic [7:0] index6;
  logic [15:0] fraction6;
  logic [4:0] pairs6;
  assign doubled1 = squared_width_odd1 ? {rest1[ROW-2-:29], 1'b0} : {1'b0, rest1[ROW-2-:29]};
  always_ff @(posedge clk) begin
    doubled2 <= doubled1;
    squared_width2 <= squared_width1;
  end
  generate
    if (THREE) begin : gen_three
      logic [17:0] doubled_sum2, squared_width_sum2;
      always_ff @(posedge clk) begin
        doubled_sum2 <= splatline_math::halves(34'(doubled1));
        squared_width_sum2 <= splatline_math::halves(34'(squared_width1));
      end
      multiply_three #(.LEFT(30), .RIGHT(M)) multiply_half (.clk, .advance(1'b1), .left(doubled2), .left_sum(doubled_sum2), .right(squared_width2), .right_sum(squared_width_sum2), .low(), .product(product4));
    end else begin : gen_usual
      multiply #(.LEFT(30), .RIGHT(M)) multiply_half (.clk, .advance(1'b1), .left(doubled2), .right(squared_width2), .low(), .product(product4));
    end
  endgenerate
  assign squared4 = 64'(product4);
  // Pairs of leading zeros, 31 where there is nothing: eights of them in one stage, the others in the next.
  logic [7:1] some5;
  assign sixteenth4 = splatline_math::leading({|squared4[63:48], |squared4[47:32], |squared4[31:16]});
  assign sixteens4 = ~sixteenth4;
  always_comb for (int i = 1; i < 8; i = i + 1) some5[i] = squared5[48+2*i] || squared5[49+2*i];
  assign pair5 = splatline_math::leading(some5[7:4] != 0 ? some5[7:5] : some5[3:1]);
  assign pairs5 = {some5[7:4] == 0, ~pair5};
  assign normal5 = squared5 << {pairs5, 1'b0};
  always_ff @(posedge clk) begin
    squared5 <= squared4 << {sixteens4, 4'd0};
    sixteens5 <= sixteens4;
    index6 <= normal5[63:56];
    fraction6 <= normal5[55:40];
    pairs6 <= {sixteens5, pairs5};
  end

  // Stages 7 and 8: the root table's entry and the step to the next. Stage 10: the root, UQ0.24, and its left shift to
  // Q.32 pixels.
  logic [40:0] entry7, entry8;
  logic [15:0] fraction7, fraction8;
  logic [4:0] pairs7, pairs8;
  logic [23:0] low9;
  logic [32:0] step9, risen9;
  logic [24:0] root10;
  logic signed [E-1:0] power9, power10;
  assign risen9 = step9 + 33'h8000;
  always_ff @(posedge clk) begin
    entry7 <= splatline_tables::root_entry(index6);
    fraction7 <= fraction6;
    pairs7 <= pairs6;
    entry8 <= entry7;
    fraction8 <= fraction7;
    pairs8 <= pairs7;
    low9 <= entry8[23:0];
    step9 <= entry8[40:24] * fraction8;
    power9 <= E'($signed({1'b0, pairs8})) - E'(8) - squared_width_power8;
    root10 <= {1'b0, low9} + {8'd0, risen9[32:16]};
    power10 <= power9;
  end

  // Stage 15: the half-width, rounded to Q.32, without the bits that xc does not have. Stage 17: where the span begins
  // and ends.
  logic signed [63:0] half14;
  logic signed [CENTRE:0] half15, low16, high16;
  logic signed [CENTRE-1:0] centre15, centre19;
  logic signed [32:0] low17, high17;
  align #(.BITS(25), .SHIFT(E)) align_half (.clk, .negative(1'b0), .magnitude(root10), .shift(power10), .result(half14));
  delay #(.BITS(CENTRE + 1), .STAGES(14)) hold_centre15 (.clk, .rst, .advance(1'b1), .in({coarse1, centre1}), .out({coarse15, centre15}));
  delay #(.BITS(CENTRE + 1), .STAGES(4)) hold_centre19 (.clk, .rst, .advance(1'b1), .in({coarse15, centre15}), .out({coarse19, centre19}));
  delay #(.BITS(1), .STAGES(13)) hold_coarse14 (.clk, .rst, .advance(1'b1), .in(coarse1), .out(coarse14));
  always_ff @(posedge clk) begin
    half15 <= (CENTRE + 1)'(coarse14 ? half14 >>> (32 - COARSE) : half14 >>> (32 - FINE));
    coarse16 <= coarse15;
    low16 <= (CENTRE + 1)'(centre15) - half15;
    high16 <= (CENTRE + 1)'(centre15) + half15;
    low17 <= 33'(coarse16 ? low16 >>> COARSE : low16 >>> FINE) + $signed({32'd0, coarse16 ? (low16 & COARSE_REST) != 0 : low16[FINE-1:0] != 0});
    high17 <= 33'(coarse16 ? high16 >>> COARSE : high16 >>> FINE) + 33'sd1;
  end

  // Stages 18 to 20: the span within the window.
  logic [15:0] start_column17, end_column17, x19;
  logic [COLUMN_BITS-1:0] column20;
  logic [COLUMN_BITS:0] count20;
  delay #(.BITS(2 * 16 + 6), .STAGES(16)) hold_columns (.clk, .rst, .advance(1'b1), .in({start_column1, end_column1, drop_dx1}), .out({start_column17, end_column17, drop_dx17}));
  row_window cut (.clk, .low(low17), .high(high17), .start_column(start_column17), .end_column(end_column17), .x19, .holds20, .column20, .count20);

  // Stage 21: dx, rounded, as a magnitude (`Seed::at`). Back to one in the same addition: -(q + d) = ~q + !d.
  logic signed [CENTRE:0] distance20;
  logic [M+4:0] fours21;
  logic [M+1:0] moved21;
  logic [1:0] rest21;
  logic negative21, negative22, negative24;
  logic [M:0] dx21;
  delay #(.BITS(6), .STAGES(3)) hold_drop_dx (.clk, .rst, .advance(1'b1), .in(drop_dx17), .out(drop_dx20));
  // Shifted by fours, and in the next stage by what is left.
  assign moved21 = (M + 2)'(fours21 >> rest21);
  assign dx21 = (negative21 ? ~moved21[M+1:1] : moved21[M+1:1]) + {{M{1'b0}}, moved21[0] != negative21};
  always_ff @(posedge clk) begin
    distance20 <= (coarse19 ? (CENTRE + 1)'(x19) << COARSE : (CENTRE + 1)'(x19) << FINE) - (CENTRE + 1)'(centre19);
    fours21 <= (M + 5)'($signed({distance20, 1'b0}) >>> {drop_dx20[5:2], 2'b00});
    rest21 <= drop_dx20[1:0];
    negative21 <= distance20[CENTRE];
    negative22 <= negative21;
  end
  delay #(.BITS(1), .STAGES(2)) hold_negative (.clk, .rst, .advance(1'b1), .in(negative22), .out(negative24));
  delay #(.BITS(M + E), .STAGES(21 - LATE)) hold_horizontal (.clk, .rst, .advance(1'b1), .in({horizontal1, drop_first1}), .out({horizontal, drop_first}));
  delay #(.BITS(E), .STAGES(LATE)) hold_drop_first22 (.clk, .rst, .advance(1'b1), .in(drop_first), .out(drop_first22));

  // Stage 29: the first difference. Stage 31: the radial index without its constants.
  logic [31:0] first28, radial31;
  logic signed [7:0] more21, more22;
  logic [31:0] first29;
  delay #(.BITS(E), .STAGES(2)) hold_drop_first (.clk, .rst, .advance(1'b1), .in(drop_first22), .out(drop_first24));
  delay #(.BITS(E), .STAGES(4)) hold_drop_radial (.clk, .rst, .advance(1'b1), .in(drop_radial23), .out(drop_radial27));
  // The radial index has the product of one dx more and a rounded mantissa less than its difference, which has a
  // factor of two.
  always_ff @(posedge clk) begin
    coarse20 <= coarse19;
    more21 <= 8'(coarse20 ? COARSE + 1 - M : FINE + 1 - M) - $signed({2'b00, drop_dx20});
    more22 <= more21;
    drop_radial23 <= drop_first22 + E'(more22);
  end
  delay #(.BITS(32), .STAGES(27)) hold_unit (.clk, .rst, .advance(1'b1), .in(unit1), .out(unit28));
  row_seed #(.INTERVAL(INTERVAL), .THREE(THREE)) seed (.clk, .rst, .phase, .dx21, .horizontal, .negative24, .drop_first24, .drop_radial27, .first28, .radial31);
  always_ff @(posedge clk) first29 <= first28 + unit28;

  // Stage 3: C dy^2 and what balances the seed. Stage 32: the radial index.
  localparam signed [ROW-1:0] VERTICAL_HALF = ROW'(1) << (VERTICAL - RADIAL - 1);
  logic [31:0] base2, base3, base31, radial32;
  always_ff @(posedge clk) begin
    base2 <= 32'((vertical1 + VERTICAL_HALF) >>> (VERTICAL - RADIAL));
    balance2 <= balance1;
    base3 <= base2 + balance2;
    radial32 <= radial31 + base31;
  end
  delay #(.BITS(32), .STAGES(28)) hold_base (.clk, .rst, .advance(1'b1), .in(base3), .out(base31));

  // The slot's run, in parts as they are ready: in stages 1, 20, 29 and 32. Whoever takes it asks for lane and run a
  // cycle before.
  localparam PART_1 = ROW_BITS + 32 + $bits(cutoff1) + $bits(paint1);
  localparam PART_20 = PART_1 + 2 * COLUMN_BITS + 1;
  localparam PART_29 = PART_20 + 32;
  localparam PART_32 = PART_29 + 32;
  localparam SLOT = PART_32 + 1;
  localparam PARTS = LANE_BITS == 0 ? 5 : 6;
  logic [SLOT-1:0] next;
  assign next_has_run = next[SLOT-1];
  assign next_lane = next[ROW_BITS-1:0];
  fifo #(
      .BITS(SLOT),
      .PLACES(PLACES),
      .PARTS(PARTS),
      .ENDS((16 * PARTS)'({16'(SLOT), 16'(PART_32), 16'(PART_29), 16'(PART_20), 16'(PART_1), 16'(LANE_BITS)} >> 16 * (6 - PARTS))),
      .SEEN(PARTS'(6'b100001 >> (6 - PARTS)))
  ) slots (
      .clk,
      .rst,
      .claim(issue),
      .free(place),
      .none,
      .in_valid(PARTS'({slot[STAGES], slot[STAGES], slot[29], slot[20], slot[1], slot[1]} >> (6 - PARTS))),
      .in({open[STAGES], radial32, first29, column20, count20, second1, cutoff1, paint1, row1}),
      .out_valid(slot_valid),
      .out_ready(slot_ready),
      .out({slot_has_run, run.radial, run.first, run.column, run.count, run.second, run.cutoff, paint, run.row}),
      .next
  );
  assign idle = !busy && none;
endmodule
