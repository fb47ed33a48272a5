// From splats to runs of pixels: one row of a splat a cycle (`next_row` and `next_block` of src/raster/spans.rs).
//
// Down the rows, xc and C dy^2 are differenced; then 32 stages compute the row's span by the root table, the lanes' seed by two
// multiplications, and drop what lies left of the window. The window must lie within one block of columns, so that a row
// is one run, and begin with a block's first row. A row without pixels travels as a bubble, and so does a splat without rows, so that cycles depend on the number
// of rows and on the lengths of the runs alone.
//
// Stages never stand still. A row is only issued if the queue behind the stages has a place for it (`slot_valid`: a row, with or without
// a run), so that nothing is stopped half way. A name's number is the stage: 0 while the row is being issued.
module row_generator (
    input logic clk,
    input logic rst,
    input logic splat_valid,
    output logic splat_ready,
    input splatline_pkg::start_t start,
    input splatline_pkg::shape_t shape,
    output logic slot_valid,
    input logic slot_ready,
    output logic slot_has_run,
    output splatline_pkg::run_t run,
    output splatline_pkg::paint_t paint,
    output logic idle
);
  localparam M = splatline_pkg::MANTISSA;
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
  localparam STAGES = 32;
  // Rows from issue to the lanes' queues: twice the stages, so that the queue never runs dry while places come back.
  localparam PLACES = 64;

  // The splat whose rows are being issued: the row, and what is differenced down the rows.
  logic busy, place, issue, none, some0;
  logic [ROW_BITS-1:0] row0;
  logic signed [CENTRE-1:0] centre0, shear0;
  logic signed [ROW-1:0] vertical0, first0, second0;
  splatline_pkg::shape_t shape0;
  row_counter counter (.clk, .rst, .splat_valid, .splat_ready, .first(start.row), .rows(start.rows), .place, .busy, .issue, .row(row0), .some(some0));
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
  logic positive1, holds19;
  always_ff @(posedge clk) begin
    if (rst) begin
      slot <= 0;
      open <= 0;
    end else begin
      slot <= {slot[STAGES-1:1], issue};
      open <= {open[STAGES-1:20], open[19] && holds19, open[18:2], open[1] && positive1, issue && some0};
    end
  end

  // Stage 1: the row; what is left of the cut-off, Q.vertical.
  logic signed [CENTRE-1:0] centre1;
  logic signed [ROW-1:0] vertical1, rest1;
  logic coarse1, coarse13, coarse14, coarse15, coarse18, coarse19;
  logic [ROW_BITS-1:0] row1;
  logic [M-1:0] squared_width1;
  logic [RADIAL+4:0] cutoff1;
  splatline_pkg::paint_t paint1;
  logic [15:0] start_column1, end_column1;
  logic [splatline_pkg::BLOCK_BITS-1:0] first_column1, first_column16;
  logic squared_width_odd1;
  logic signed [15:0] squared_width_power1, squared_width_power7;
  logic [5:0] drop_dx1, drop_dx16, drop_dx19;
  logic [M-1:0] horizontal1, horizontal21;
  logic signed [15:0] drop_first1, drop_first21, drop_first23, drop_radial22, drop_radial26;
  logic [31:0] second1, second20, unit1, unit27, balance1, balance2;
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
    {start_column1, first_column1, end_column1} <= {shape0.start_column, shape0.first_column, shape0.end_column};
    drop_dx1 <= shape0.drop_dx;
    horizontal1 <= shape0.horizontal;
    drop_first1 <= shape0.drop_first;
    second1 <= shape0.second;
    unit1 <= shape0.unit;
    balance1 <= shape0.balance;
  end
  assign positive1 = !rest1[ROW-1] && rest1 != 0;
  delay #(.BITS(16), .STAGES(6)) hold_power (.clk, .rst, .advance(1'b1), .in(squared_width_power1), .out(squared_width_power7));

  // Stage 3: the squared half-width, Q.24 before the exponent. Stage 5: brought to [1/4, 1) by an even shift.
  logic [29:0] doubled1;
  logic [M+29:0] product3;
  logic [63:0] squared3, squared4, normal4;
  logic [1:0] sixteenth3, sixteens3, sixteens4, pair4;
  logic [2:0] pairs4;
  logic [7:0] index5;
  logic [15:0] fraction5;
  logic [4:0] pairs5;
  assign doubled1 = squared_width_odd1 ? {rest1[ROW-2-:29], 1'b0} : {1'b0, rest1[ROW-2-:29]};
  multiply #(.LEFT(30), .RIGHT(M)) multiply_half (.clk, .advance(1'b1), .left(doubled1), .right(squared_width1), .product(product3));
  assign squared3 = 64'(product3);
  // Pairs of leading zeros, 31 where there is nothing: eights of them in one stage, the others in the next.
  logic [7:1] some4;
  assign sixteenth3 = splatline_math::leading({|squared3[63:48], |squared3[47:32], |squared3[31:16]});
  assign sixteens3 = ~sixteenth3;
  always_comb for (int i = 1; i < 8; i = i + 1) some4[i] = squared4[48+2*i] || squared4[49+2*i];
  assign pair4 = splatline_math::leading(some4[7:4] != 0 ? some4[7:5] : some4[3:1]);
  assign pairs4 = {some4[7:4] == 0, ~pair4};
  assign normal4 = squared4 << {pairs4, 1'b0};
  always_ff @(posedge clk) begin
    squared4 <= squared3 << {sixteens3, 4'd0};
    sixteens4 <= sixteens3;
    index5 <= normal4[63:56];
    fraction5 <= normal4[55:40];
    pairs5 <= {sixteens4, pairs4};
  end

  // Stages 6 and 7: the root table's entry and the step to the next. Stage 9: the root, UQ0.24, and its left shift to Q.32 pixels.
  logic [40:0] entry6, entry7;
  logic [15:0] fraction6, fraction7;
  logic [4:0] pairs6, pairs7;
  logic [23:0] low8;
  logic [32:0] step8, risen8;
  logic [24:0] root9;
  logic signed [15:0] power8, power9;
  assign risen8 = step8 + 33'h8000;
  always_ff @(posedge clk) begin
    entry6 <= splatline_tables::root_entry(index5);
    fraction6 <= fraction5;
    pairs6 <= pairs5;
    entry7 <= entry6;
    fraction7 <= fraction6;
    pairs7 <= pairs6;
    low8 <= entry7[23:0];
    step8 <= entry7[40:24] * fraction7;
    power8 <= $signed({11'd0, pairs7}) - 16'sd8 - squared_width_power7;
    root9 <= {1'b0, low8} + {8'd0, risen8[32:16]};
    power9 <= power8;
  end

  // Stage 14: the half-width, rounded to Q.32, without the bits that xc does not have. Stage 16: where the span begins and ends.
  logic signed [63:0] half13;
  logic signed [CENTRE:0] half14, low15, high15;
  logic signed [CENTRE-1:0] centre14, centre18;
  logic signed [32:0] low16, high16;
  align #(.BITS(25)) align_half (.clk, .negative(1'b0), .magnitude(root9), .shift(power9), .result(half13));
  delay #(.BITS(CENTRE + 1), .STAGES(13)) hold_centre14 (.clk, .rst, .advance(1'b1), .in({coarse1, centre1}), .out({coarse14, centre14}));
  delay #(.BITS(CENTRE + 1), .STAGES(4)) hold_centre18 (.clk, .rst, .advance(1'b1), .in({coarse14, centre14}), .out({coarse18, centre18}));
  delay #(.BITS(1), .STAGES(12)) hold_coarse13 (.clk, .rst, .advance(1'b1), .in(coarse1), .out(coarse13));
  always_ff @(posedge clk) begin
    half14 <= (CENTRE + 1)'(coarse13 ? half13 >>> (32 - COARSE) : half13 >>> (32 - FINE));
    coarse15 <= coarse14;
    low15 <= (CENTRE + 1)'(centre14) - half14;
    high15 <= (CENTRE + 1)'(centre14) + half14;
    low16 <= 33'(coarse15 ? low15 >>> COARSE : low15 >>> FINE) + $signed({32'd0, coarse15 ? (low15 & COARSE_REST) != 0 : low15[FINE-1:0] != 0});
    high16 <= 33'(coarse15 ? high15 >>> COARSE : high15 >>> FINE) + 33'sd1;
  end

  // Stages 17 to 20: the span within the window.
  logic [15:0] start_column16, end_column16, x18;
  logic [COLUMN_BITS-1:0] column20;
  logic [4:0] head20, head28;
  logic [COLUMN_BITS:0] count20;
  delay #(.BITS(2 * 16 + splatline_pkg::BLOCK_BITS + 6), .STAGES(15)) hold_columns (.clk, .rst, .advance(1'b1), .in({start_column1, first_column1, end_column1, drop_dx1}), .out({start_column16, first_column16, end_column16, drop_dx16}));
  row_window cut (.clk, .low(low16), .high(high16), .start_column(start_column16), .first_column(first_column16), .end_column(end_column16), .x18, .holds19, .head20, .column20, .count20);
  delay #(.BITS(5), .STAGES(8)) hold_head (.clk, .rst, .advance(1'b1), .in(head20), .out(head28));

  // Stage 21: dx, rounded, as a magnitude (`Seed::at`). Back to one in the same addition: -(q + d) = ~q + !d.
  logic signed [CENTRE:0] distance19;
  logic [M+4:0] fours20;
  logic [M+1:0] moved20;
  logic [1:0] rest20;
  logic negative20, negative21, negative23;
  logic [M:0] dx21, dx24;
  delay #(.BITS(6), .STAGES(3)) hold_drop_dx (.clk, .rst, .advance(1'b1), .in(drop_dx16), .out(drop_dx19));
  // Shifted by fours, and in the next stage by what is left.
  assign moved20 = (M + 2)'(fours20 >> rest20);
  always_ff @(posedge clk) begin
    distance19 <= (coarse18 ? (CENTRE + 1)'(x18) << COARSE : (CENTRE + 1)'(x18) << FINE) - (CENTRE + 1)'(centre18);
    fours20 <= (M + 5)'($signed({distance19, 1'b0}) >>> {drop_dx19[5:2], 2'b00});
    rest20 <= drop_dx19[1:0];
    negative20 <= distance19[CENTRE];
    dx21 <= (negative20 ? ~moved20[M+1:1] : moved20[M+1:1]) + {{M{1'b0}}, moved20[0] != negative20};
    negative21 <= negative20;
  end
  delay #(.BITS(M + 1), .STAGES(3)) hold_dx (.clk, .rst, .advance(1'b1), .in(dx21), .out(dx24));
  delay #(.BITS(1), .STAGES(2)) hold_negative (.clk, .rst, .advance(1'b1), .in(negative21), .out(negative23));
  delay #(.BITS(M + 16), .STAGES(20)) hold_horizontal (.clk, .rst, .advance(1'b1), .in({horizontal1, drop_first1}), .out({horizontal21, drop_first21}));

  // Stage 23: A dx. Stage 24: rounded to a mantissa. Stage 26: A dx^2, which is never negative.
  logic [2*M:0] along23, along_rounded23;
  logic [M:0] slant24;
  logic [2*M+1:0] across26;
  multiply #(.LEFT(M + 1), .RIGHT(M)) multiply_along (.clk, .advance(1'b1), .left(dx21), .right(horizontal21), .product(along23));
  multiply #(.LEFT(M + 1), .RIGHT(M + 1)) multiply_across (.clk, .advance(1'b1), .left(slant24), .right(dx24), .product(across26));
  // Halves up, whatever the sign.
  assign along_rounded23 = along23 + (negative23 ? (2 * M + 1)'((1 << (M - 1)) - 1) : (2 * M + 1)'(1 << (M - 1)));
  always_ff @(posedge clk) slant24 <= along_rounded23[2*M:M];

  // Stage 28: the first difference. Stage 30: the radial index without its constants.
  logic signed [63:0] first27, radial30;
  logic signed [7:0] more20, more21;
  logic [31:0] first28;
  delay #(.BITS(16), .STAGES(2)) hold_drop_first (.clk, .rst, .advance(1'b1), .in(drop_first21), .out(drop_first23));
  delay #(.BITS(16), .STAGES(4)) hold_drop_radial (.clk, .rst, .advance(1'b1), .in(drop_radial22), .out(drop_radial26));
  // The radial index has the product of one dx more and a rounded mantissa less than its difference, which has a
  // factor of two.
  always_ff @(posedge clk) begin
    coarse19 <= coarse18;
    more20 <= 8'(coarse19 ? COARSE + 1 - M : FINE + 1 - M) - $signed({2'b00, drop_dx19});
    more21 <= more20;
    drop_radial22 <= drop_first21 + 16'(more21);
  end
  delay #(.BITS(32), .STAGES(26)) hold_unit (.clk, .rst, .advance(1'b1), .in(unit1), .out(unit27));
  align #(.BITS(2 * M + 1)) align_first (.clk, .negative(negative23), .magnitude(along23), .shift(drop_first23), .result(first27));
  align #(.BITS(2 * M + 2)) align_radial (.clk, .negative(1'b0), .magnitude(across26), .shift(drop_radial26), .result(radial30));
  always_ff @(posedge clk) first28 <= first27[31:0] + unit27;

  // C dy^2 and what balances the seed: stage 3. What is left of the window is skipped (`Run::skip`): stages 22 to 32. Over n pixels the index
  // grows by n first + n (n - 1) / 2 second = n (2 first + (n - 1) second) / 2: one product more, and a bit more, since n (n - 1) is even.
  localparam signed [ROW-1:0] VERTICAL_HALF = ROW'(1) << (VERTICAL - RADIAL - 1);
  logic [31:0] base2, base3, base30, sum31, radial32, first29, second27;
  logic [36:0] head_second22;
  logic [32:0] head_second27, less28, mean29;
  logic [31:0] head_second28;
  logic [4:0] head29;
  logic [37:0] skipped31;
  always_ff @(posedge clk) begin
    base2 <= 32'((vertical1 + VERTICAL_HALF) >>> (VERTICAL - RADIAL));
    balance2 <= balance1;
    base3 <= base2 + balance2;
    less28 <= head_second27 - {1'b0, second27};
    head_second28 <= head_second27[31:0];
    mean29 <= {first28, 1'b0} + less28;
    head29 <= head28;
    first29 <= first28 + head_second28;
    sum31 <= radial30[31:0] + base30;
    radial32 <= sum31 + skipped31[32:1];
  end
  delay #(.BITS(32), .STAGES(27)) hold_base (.clk, .rst, .advance(1'b1), .in(base3), .out(base30));
  delay #(.BITS(32), .STAGES(19)) hold_second20 (.clk, .rst, .advance(1'b1), .in(second1), .out(second20));
  delay #(.BITS(32), .STAGES(7)) hold_second27 (.clk, .rst, .advance(1'b1), .in(second20), .out(second27));
  delay #(.BITS(33), .STAGES(5)) hold_head_second (.clk, .rst, .advance(1'b1), .in(head_second22[32:0]), .out(head_second27));
  multiply #(.LEFT(32), .RIGHT(5)) multiply_head_second (.clk, .advance(1'b1), .left(second20), .right(head20), .product(head_second22));
  multiply #(.LEFT(33), .RIGHT(5)) multiply_skipped (.clk, .advance(1'b1), .left(mean29), .right(head29), .product(skipped31));

  // The slot's run, in parts as they are ready: in stages 1, 20, 29 and 32.
  localparam PART_1 = ROW_BITS + 32 + $bits(cutoff1) + $bits(paint1);
  localparam PART_20 = PART_1 + 2 * COLUMN_BITS + 1;
  localparam PART_29 = PART_20 + 32;
  localparam PART_32 = PART_29 + 1 + 32;
  fifo #(
      .BITS(PART_32),
      .PLACES(PLACES),
      .PARTS(4),
      .ENDS({16'(PART_32), 16'(PART_29), 16'(PART_20), 16'(PART_1)})
  ) slots (
      .clk,
      .rst,
      .claim(issue),
      .free(place),
      .none,
      .in_valid({slot[STAGES], slot[29], slot[20], slot[1]}),
      .in({open[STAGES], radial32, first29, column20, count20, row1, second1, cutoff1, paint1}),
      .out_valid(slot_valid),
      .out_ready(slot_ready),
      .out({slot_has_run, run.radial, run.first, run.column, run.count, run.row, run.second, run.cutoff, paint})
  );
  assign idle = !busy && none;
endmodule
