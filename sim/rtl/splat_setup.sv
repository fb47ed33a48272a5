// From a footprint to its first visible row: `SpanRows::new` of src/raster/spans.rs as a pipeline of eight stages, one splat a cycle.
//
// The jump over rows above the window uses that the second difference is twice C (`unit`): with q = n C,
// n first + n (n - 1) / 2 second = n (first + q - C), exactly modulo 2^64. All stages move together, or none.
module splat_setup (
    input logic clk,
    input logic rst,
    input splatline_pkg::window_t window,
    input logic footprint_valid,
    output logic footprint_ready,
    input splatline_pkg::footprint_t footprint,
    output logic splat_valid,
    input logic splat_ready,
    output splatline_pkg::start_t start,
    output splatline_pkg::shape_t shape,
    output logic idle
);
  localparam M = splatline_pkg::MANTISSA;
  localparam SUBPIXEL = splatline_pkg::SUBPIXEL;
  localparam RADIAL = splatline_pkg::RADIAL;
  localparam BLOCK_BITS = splatline_pkg::BLOCK_BITS;
  localparam GUARD = splatline_pkg::GUARD;
  // Slack on the cut-off that makes spans conservative: 2^-10 in Q.52.
  localparam [55:0] SLACK = 56'd1 << 42;

  // One more than a mantissa has, and a sign: a rounded number before its overflow is put right.
  typedef struct packed {
    logic signed [M+1:0] mantissa;
    logic signed [15:0] exponent;
  } scaled_t;

  // `Scaled::from_wide`: the magnitude rounded to M bits, as the bits of a `scaled_t`.
  function automatic logic [M+17:0] normalise(input logic signed [63:0] value, input logic signed [15:0] exponent);
    logic signed [15:0] shift;
    logic signed [63:0] rounded;
    logic overflow;
    shift = $signed({9'd0, splatline_math::length(value[63] ? -value : value)}) - $signed(16'(M));
    rounded = splatline_math::shift_signed(value, shift);
    overflow = rounded == (64'sd1 <<< M) || rounded == -(64'sd1 <<< M);
    normalise = overflow ? {rounded[M+2:1], exponent + shift + 16'sd1} : {rounded[M+1:0], exponent + shift};
  endfunction

  // Right shift that brings a number with this exponent to `fraction` bits.
  function automatic logic signed [15:0] to_fraction(input logic signed [15:0] exponent, input logic signed [15:0] fraction);
    to_fraction = 16'sd0 - exponent - fraction;
  endfunction

  function automatic logic signed [15:0] extend(input logic [9:0] exponent);
    extend = {{6{exponent[9]}}, exponent};
  endfunction

  logic advance;
  assign advance = !splat_valid || splat_ready;
  assign footprint_ready = advance;

  // Stage 1: the footprint.
  logic valid1;
  splatline_pkg::footprint_t f1;
  logic [15:0] row1, last_row1, first_column1, last_column1;
  assign row1 = f1.first_row > window.first_row ? f1.first_row : window.first_row;
  assign last_row1 = f1.last_row < window.last_row ? f1.last_row : window.last_row;
  assign first_column1 = f1.first_column > window.first_column ? f1.first_column : window.first_column;
  assign last_column1 = f1.last_column < window.last_column ? f1.last_column : window.last_column;

  // Stage 2: what is visible; the distance of the first row's sample points from the centre, Q.subpixel.
  logic valid2;
  splatline_pkg::footprint_t f2;
  splatline_pkg::shape_t shape2;
  logic [15:0] row2, last_row2, skipped2;
  logic signed [63:0] dy_wide2, slope2, unit2;

  // Stage 3: that distance as mantissa and exponent.
  logic valid3;
  splatline_pkg::footprint_t f3;
  splatline_pkg::shape_t shape3;
  logic [15:0] row3, last_row3, skipped3;
  logic signed [63:0] slope3, unit3, fine3;
  logic signed [15:0] half3;
  scaled_t dy3;

  // Stage 4: C dy and S dy; the jump's first products.
  logic valid4;
  splatline_pkg::shape_t shape4;
  logic [15:0] row4, last_row4, skipped4;
  logic signed [63:0] slope4, unit4, centre4, jump_slope4, jump_unit4;
  logic signed [2*M+3:0] along4, shear4;
  logic signed [15:0] along_exponent4, shear_exponent4;
  scaled_t dy4;

  // Stage 5: C dy rounded to a mantissa; the first row's centre.
  logic valid5;
  splatline_pkg::shape_t shape5;
  logic [15:0] row5, last_row5, skipped5;
  logic signed [63:0] slope5, unit5, centre5, jump_unit5;
  scaled_t along5, dy5;

  // Stage 6: C dy^2; the first difference.
  logic valid6;
  splatline_pkg::shape_t shape6;
  logic [15:0] row6, last_row6, skipped6;
  logic signed [63:0] slope6, unit6, centre6, jump_unit6, first6;
  logic signed [2*M+3:0] square6;
  logic signed [15:0] square_exponent6;

  // Stage 7: before the jump. Stage 8, the output: after it.
  logic valid7;
  splatline_pkg::shape_t shape7;
  logic [15:0] row7, last_row7, skipped7;
  logic signed [63:0] slope7, unit7, centre7, jump_unit7, first7, vertical7, mean7;

  // `Seed::new`: unit of dx and the alignments that follow from it, constants of the footprint.
  logic signed [15:0] spread_leading2, half_leading2, drop_wide3, drop3, power3;
  assign spread_leading2 = extend(f2.spread_exponent) + $signed({9'd0, splatline_math::length({{(64 - M) {1'b0}}, f2.spread_mantissa})}) - 16'sd1;
  assign half_leading2 = (spread_leading2 + 16'sd6) >>> 1;
  assign drop_wide3 = half3 + 16'sd32 - $signed(16'(M));
  assign drop3 = drop_wide3 < 0 ? 16'sd0 : drop_wide3 > 63 ? 16'sd63 : drop_wide3;
  assign power3 = extend(f3.curvature_exponent) + drop3 - 16'sd32;

  // `Balance::new`.
  logic signed [63:0] second3, rounded3, excess3, balanced3, start3;
  assign second3 = splatline_math::shift_round(fine3, 7'(GUARD - 1));
  assign rounded3 = second3 <<< (GUARD - 1);
  assign excess3 = rounded3 - fine3;
  assign balanced3 = splatline_math::shift_round(rounded3 - (excess3 <<< BLOCK_BITS), 7'(GUARD));
  assign start3 = splatline_math::shift_round(excess3 <<< (2 * BLOCK_BITS - 3), 7'(GUARD));

  logic [31:0] cutoff_rounded1;
  generate
    if (RADIAL == 28) begin : gen_cutoff_exact
      assign cutoff_rounded1 = f1.cutoff;
    end else begin : gen_cutoff_rounded
      logic [32:0] sum;
      assign sum = {1'b0, f1.cutoff} + (33'd1 << (27 - RADIAL));
      assign cutoff_rounded1 = 32'(sum >> (28 - RADIAL));
    end
  endgenerate

  always_ff @(posedge clk) begin
    if (rst) begin
      valid1 <= 0;
      valid2 <= 0;
      valid3 <= 0;
      valid4 <= 0;
      valid5 <= 0;
      valid6 <= 0;
      valid7 <= 0;
      splat_valid <= 0;
    end else if (advance) begin
      valid1 <= footprint_valid;
      valid2 <= valid1;
      valid3 <= valid2;
      valid4 <= valid3;
      valid5 <= valid4;
      valid6 <= valid5;
      valid7 <= valid6;
      splat_valid <= valid7;
    end
    if (advance) begin
      f1 <= footprint;

      f2 <= f1;
      row2 <= row1;
      // No row is visible if the window holds none of the box's columns.
      last_row2 <= first_column1 < last_column1 ? last_row1 : 16'd0;
      skipped2 <= row1 - f1.first_row;
      dy_wide2 <= $signed({46'd0, f1.first_row, 1'b1, 1'b0}) * (64'sd1 <<< (SUBPIXEL - 2)) - 64'($signed(f1.centre_v));
      slope2 <= splatline_math::shift_signed(64'($signed(f1.slope_mantissa)), to_fraction(extend(f1.slope_exponent), 16'sd32));
      unit2 <= splatline_math::shift_signed($signed({{(64 - M) {1'b0}}, f1.stretch_mantissa}), to_fraction(extend(f1.stretch_exponent), 16'sd52));
      shape2 <= '0;
      shape2.box_first <= f1.first_column;
      shape2.box_last <= f1.last_column;
      shape2.first_column <= first_column1;
      shape2.last_column <= last_column1;
      shape2.reach <= {f1.cutoff, 24'd0} + SLACK;
      shape2.spread <= f1.spread_mantissa;
      shape2.spread_odd <= f1.spread_exponent[0];
      shape2.spread_power <= (extend(f1.spread_exponent) >>> 1) + 16'sd18;
      shape2.curvature <= f1.curvature_mantissa;
      shape2.paint.cutoff <= cutoff_rounded1[RADIAL+4:0];
      shape2.paint.peak <= f1.peak;
      shape2.paint.red <= f1.red;
      shape2.paint.green <= f1.green;
      shape2.paint.blue <= f1.blue;

      f3 <= f2;
      shape3 <= shape2;
      row3 <= row2;
      last_row3 <= last_row2;
      skipped3 <= skipped2;
      slope3 <= slope2;
      unit3 <= unit2;
      dy3 <= normalise(dy_wide2, -$signed(16'(SUBPIXEL)));
      half3 <= half_leading2;
      fine3 <= splatline_math::shift_signed($signed({{(64 - M) {1'b0}}, f2.curvature_mantissa}), to_fraction(extend(f2.curvature_exponent), $signed(16'(RADIAL + GUARD))));

      shape4 <= shape3;
      shape4.drop_dx <= drop3[5:0];
      shape4.drop_radial <= 16'sd0 - (power3 + drop3 - 16'sd32 + $signed(16'(M)) + $signed(16'(RADIAL)));
      shape4.drop_first <= 16'sd0 - (power3 + 16'sd1 + $signed(16'(RADIAL)));
      shape4.second <= second3[31:0];
      shape4.unit <= balanced3[31:0];
      shape4.balance <= start3[31:0];
      row4 <= row3;
      last_row4 <= last_row3;
      skipped4 <= skipped3;
      slope4 <= slope3;
      unit4 <= unit3;
      along4 <= $signed({2'b0, f3.stretch_mantissa}) * dy3.mantissa;
      along_exponent4 <= extend(f3.stretch_exponent) + dy3.exponent;
      shear4 <= $signed(f3.slope_mantissa) * dy3.mantissa;
      shear_exponent4 <= extend(f3.slope_exponent) + dy3.exponent;
      centre4 <= (64'($signed(f3.centre_u)) <<< (32 - SUBPIXEL)) - (64'sd1 <<< 31);
      jump_slope4 <= slope3 * $signed({48'd0, skipped3});
      jump_unit4 <= unit3 * $signed({48'd0, skipped3});
      dy4 <= dy3;

      shape5 <= shape4;
      row5 <= row4;
      last_row5 <= last_row4;
      skipped5 <= skipped4;
      slope5 <= slope4;
      unit5 <= unit4;
      centre5 <= centre4 + jump_slope4 + splatline_math::shift_signed(64'(shear4), to_fraction(shear_exponent4, 16'sd32));
      jump_unit5 <= jump_unit4;
      along5 <= normalise(64'(along4), along_exponent4);
      dy5 <= dy4;

      shape6 <= shape5;
      row6 <= row5;
      last_row6 <= last_row5;
      skipped6 <= skipped5;
      slope6 <= slope5;
      unit6 <= unit5;
      centre6 <= centre5;
      jump_unit6 <= jump_unit5;
      square6 <= along5.mantissa * dy5.mantissa;
      square_exponent6 <= along5.exponent + dy5.exponent;
      first6 <= splatline_math::shift_signed(64'(along5.mantissa), to_fraction(along5.exponent + 16'sd1, 16'sd52)) + unit5;

      shape7 <= shape6;
      row7 <= row6;
      last_row7 <= last_row6;
      skipped7 <= skipped6;
      slope7 <= slope6;
      unit7 <= unit6;
      centre7 <= centre6;
      jump_unit7 <= jump_unit6;
      first7 <= first6;
      vertical7 <= splatline_math::shift_signed(64'(square6), to_fraction(square_exponent6, 16'sd52));
      mean7 <= first6 + jump_unit6 - unit6;

      shape <= shape7;
      start.row <= row7;
      start.last_row <= last_row7;
      start.centre <= centre7;
      start.slope <= slope7;
      start.vertical <= vertical7 + mean7 * $signed({48'd0, skipped7});
      start.first <= first7 + (jump_unit7 <<< 1);
      start.second <= unit7 <<< 1;
    end
  end

  assign idle = !(valid1 || valid2 || valid3 || valid4 || valid5 || valid6 || valid7 || splat_valid);
endmodule
