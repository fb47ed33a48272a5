// From splats to runs of pixels: one row of a splat a cycle (`next_row` and `next_block` of src/raster/spans.rs).
//
// Down the rows, xc and C dy^2 are differenced; then eleven stages compute the row's span by the root table, the lanes' seed by two
// multiplications, and drop what lies left of the window. The window must lie within one block of columns, so that a row
// is one run. A row without pixels travels as a bubble, and so does a splat without rows, so that cycles depend on the number
// of rows and on the lengths of the runs alone. All stages move together, or none.
module row_generator (
    input logic clk,
    input logic rst,
    input logic splat_valid,
    output logic splat_ready,
    input splatline_pkg::start_t start,
    input splatline_pkg::shape_t shape,
    output logic run_valid,
    input logic run_ready,
    output splatline_pkg::run_t run,
    output logic idle
);
  localparam M = splatline_pkg::MANTISSA;
  localparam RADIAL = splatline_pkg::RADIAL;
  localparam BLOCK_BITS = splatline_pkg::BLOCK_BITS;

  logic advance;
  assign advance = !run_valid || run_ready;

  // The splat whose rows are being issued.
  logic busy;
  splatline_pkg::start_t at;
  splatline_pkg::shape_t shape0;
  logic issue, last;
  logic [11:0] occupied;  // stages that hold a row or a bubble
  assign issue = busy && at.row < at.last_row;
  assign last = !busy || at.row + 16'd1 >= at.last_row;
  assign splat_ready = advance && last;

  // Stage 1: the row; what is left of the cut-off.
  logic valid1;
  splatline_pkg::shape_t shape1;
  logic [15:0] row1;
  logic signed [63:0] centre1, vertical1, rest1;

  // Stage 2: the squared half-width, Q.28 before the exponent.
  logic valid2;
  splatline_pkg::shape_t shape2;
  logic [15:0] row2;
  logic signed [63:0] centre2, vertical2;
  logic [M+31:0] product2;

  // Stage 3: brought to [1/4, 1) by an even shift.
  logic valid3;
  splatline_pkg::shape_t shape3;
  logic [15:0] row3;
  logic signed [63:0] centre3, vertical3;
  logic [63:0] squared2;
  logic [6:0] zeros2;
  logic [63:0] normal2;
  logic [7:0] index3;
  logic [15:0] fraction3;
  logic [5:0] halved3;  // half of the even shift

  // Stage 4: the root table's entry and the step to the next.
  logic valid4;
  splatline_pkg::shape_t shape4;
  logic [15:0] row4;
  logic signed [63:0] centre4, vertical4;
  logic [40:0] entry4;
  logic [15:0] fraction4;
  logic [5:0] halved4;

  // Stage 5: the root, UQ0.24, and its left shift to Q.32 pixels.
  logic valid5;
  splatline_pkg::shape_t shape5;
  logic [15:0] row5;
  logic signed [63:0] centre5, vertical5;
  logic [32:0] step4;
  logic [24:0] root5;
  logic signed [15:0] power5;

  // Stage 6: the half-width, Q.32, cut to 2^62: farther than any pixel.
  logic valid6;
  splatline_pkg::shape_t shape6;
  logic [15:0] row6;
  logic signed [63:0] centre6, vertical6;
  logic signed [63:0] half5, half6;

  // Stage 7: the span, as first column, end and the part of it left of the window.
  logic valid7;
  splatline_pkg::shape_t shape7;
  logic [15:0] row7;
  logic signed [63:0] centre7, vertical7;
  logic signed [63:0] low_wide6, high_wide6;
  logic [15:0] low6, high6, block6, x6, end6, head6;
  logic [15:0] x7;
  logic [6:0] length7;
  logic [5:0] head7;

  // Stage 8: dx.
  logic valid8;
  splatline_pkg::shape_t shape8;
  logic [15:0] row8, x8;
  logic [6:0] length8;
  logic [5:0] head8;
  logic signed [63:0] vertical8;
  logic signed [63:0] distance7, rounded7;
  logic signed [M+1:0] dx8;

  // Stage 9: A dx.
  logic valid9;
  splatline_pkg::shape_t shape9;
  logic [15:0] row9, x9;
  logic [6:0] length9;
  logic [5:0] head9;
  logic [31:0] vertical9;
  logic signed [63:0] base8;
  logic signed [M+1:0] dx9;
  logic signed [2*M+2:0] along9;
  logic signed [63:0] slant9;

  // Stage 10: A dx^2 and the first difference.
  logic valid10;
  splatline_pkg::shape_t shape10;
  logic [15:0] row10, x10;
  logic [6:0] length10;
  logic [5:0] head10;
  logic [31:0] vertical10;
  logic signed [2*M+4:0] across10;
  logic signed [63:0] first_wide9;
  logic [31:0] first10;

  // Stage 11: the seed.
  logic valid11;
  splatline_pkg::shape_t shape11;
  logic [15:0] row11, x11;
  logic [6:0] length11;
  logic [5:0] head11;
  logic signed [63:0] radial_wide10;
  logic [31:0] radial11, first11;
  logic [9:0] pairs11;

  // `HalfWidth::of`: normalisation of the squared half-width by pairs of bits.
  assign squared2 = {{(32 - M) {1'b0}}, product2} << shape2.spread_odd;
  assign zeros2 = 7'd64 - splatline_math::length(squared2);
  assign normal2 = squared2 << {zeros2[5:1], 1'b0};
  assign step4 = entry4[40:24] * fraction4 + 33'h8000;
  assign half5 = splatline_math::shift_signed($signed({39'd0, root5}), 16'sd0 - power5);

  // `next_row`: the span by the half-width, within the box, the block and the window.
  assign low_wide6 = (centre6 - half6 + 64'sh0_ffff_ffff) >>> 32;
  assign high_wide6 = ((centre6 + half6) >>> 32) + 64'sd1;
  function automatic logic [15:0] clamp(input logic signed [63:0] value, input logic [15:0] first, input logic [15:0] beyond);
    if (value < $signed({48'd0, first})) clamp = first;
    else if (value > $signed({48'd0, beyond})) clamp = beyond;
    else clamp = value[15:0];
  endfunction
  assign low6 = clamp(low_wide6, shape6.box_first, shape6.box_last);
  assign high6 = clamp(high_wide6, shape6.box_first, shape6.box_last);
  assign block6 = {shape6.first_column[15:BLOCK_BITS], BLOCK_BITS'(0)};
  assign x6 = low6 > block6 ? low6 : block6;
  assign end6 = high6 < shape6.last_column ? high6 : shape6.last_column;
  assign head6 = x6 < shape6.first_column ? shape6.first_column - x6 : 16'd0;

  // `Seed::at`.
  assign distance7 = $signed({16'd0, x7, 32'd0}) - centre7;
  assign rounded7 = splatline_math::shift_round(distance7, {1'b0, shape7.drop_dx});
  assign base8 = splatline_math::shift_round(vertical8, 7'(52 - RADIAL));
  assign slant9 = splatline_math::shift_round(64'(along9), 7'(M));
  assign first_wide9 = splatline_math::shift_signed(64'(along9), shape9.drop_first);
  assign radial_wide10 = splatline_math::shift_signed(64'(across10), shape10.drop_radial);

  always_ff @(posedge clk) begin
    if (rst) begin
      busy <= 0;
      occupied <= 0;
      valid1 <= 0;
      valid2 <= 0;
      valid3 <= 0;
      valid4 <= 0;
      valid5 <= 0;
      valid6 <= 0;
      valid7 <= 0;
      valid8 <= 0;
      valid9 <= 0;
      valid10 <= 0;
      valid11 <= 0;
      run_valid <= 0;
    end else if (advance) begin
      if (last) busy <= splat_valid;
      occupied <= {occupied[10:0], busy};
      valid1 <= issue;
      valid2 <= valid1 && rest1 > 0;
      valid3 <= valid2;
      valid4 <= valid3;
      valid5 <= valid4;
      valid6 <= valid5;
      valid7 <= valid6 && x6 < end6 && head6 < end6 - x6;
      valid8 <= valid7;
      valid9 <= valid8;
      valid10 <= valid9;
      valid11 <= valid10;
      run_valid <= valid11;
    end
    if (advance) begin
      if (last) begin
        at <= start;
        shape0 <= shape;
      end else begin
        at.row <= at.row + 16'd1;
        at.centre <= at.centre + at.slope;
        at.vertical <= at.vertical + at.first;
        at.first <= at.first + at.second;
      end

      shape1 <= shape0;
      row1 <= at.row;
      centre1 <= at.centre;
      vertical1 <= at.vertical;
      rest1 <= $signed({8'd0, shape0.reach}) - at.vertical;

      shape2 <= shape1;
      row2 <= row1;
      centre2 <= centre1;
      vertical2 <= vertical1;
      product2 <= shape1.spread * rest1[55:24];

      shape3 <= shape2;
      row3 <= row2;
      centre3 <= centre2;
      vertical3 <= vertical2;
      index3 <= normal2[63:56];
      fraction3 <= normal2[55:40];
      halved3 <= zeros2[6:1];

      shape4 <= shape3;
      row4 <= row3;
      centre4 <= centre3;
      vertical4 <= vertical3;
      entry4 <= splatline_pkg::root_entry(index3);
      fraction4 <= fraction3;
      halved4 <= halved3;

      shape5 <= shape4;
      row5 <= row4;
      centre5 <= centre4;
      vertical5 <= vertical4;
      root5 <= {1'b0, entry4[23:0]} + {8'd0, step4[32:16]};
      power5 <= 16'sd8 - $signed({10'd0, halved4}) + shape4.spread_power;

      shape6 <= shape5;
      row6 <= row5;
      centre6 <= centre5;
      vertical6 <= vertical5;
      half6 <= half5[62] ? 64'sh3fff_ffff_ffff_ffff : half5;

      shape7 <= shape6;
      row7 <= row6;
      centre7 <= centre6;
      vertical7 <= vertical6;
      x7 <= x6;
      length7 <= end6[6:0] - x6[6:0];
      head7 <= head6[5:0];

      shape8 <= shape7;
      row8 <= row7;
      vertical8 <= vertical7;
      x8 <= x7;
      length8 <= length7;
      head8 <= head7;
      dx8 <= rounded7[M+1:0];

      shape9 <= shape8;
      row9 <= row8;
      vertical9 <= base8[31:0] + shape8.balance;
      x9 <= x8;
      length9 <= length8;
      head9 <= head8;
      dx9 <= dx8;
      along9 <= $signed({1'b0, shape8.curvature}) * dx8;

      shape10 <= shape9;
      row10 <= row9;
      vertical10 <= vertical9;
      x10 <= x9;
      length10 <= length9;
      head10 <= head9;
      across10 <= $signed(slant9[M+2:0]) * dx9;
      first10 <= first_wide9[31:0] + shape9.unit;

      shape11 <= shape10;
      row11 <= row10;
      x11 <= x10;
      length11 <= length10;
      head11 <= head10;
      radial11 <= radial_wide10[31:0] + vertical10;
      first11 <= first10;
      pairs11 <= ({4'd0, head10} * ({4'd0, head10} - 10'd1)) >> 1;

      // `Run::skip`.
      run.row <= row11;
      run.column <= x11 + {10'd0, head11};
      run.count <= length11 - {1'b0, head11};
      run.radial <= radial11 + {26'd0, head11} * first11 + {22'd0, pairs11} * shape11.second;
      run.first <= first11 + {26'd0, head11} * shape11.second;
      run.second <= shape11.second;
      run.paint <= shape11.paint;
    end
  end

  assign idle = !busy && occupied == 0;
endmodule
