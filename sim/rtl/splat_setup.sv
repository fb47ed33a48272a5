// From a footprint to its first visible row: `SpanRows::new` of src/raster/spans.rs as a pipeline of nineteen stages, one splat a cycle.
//
// Stages never stand still. What is ready waits in a queue, and a packet is only taken if there is a place for it, so that no signal
// has to reach every register of the unit within a cycle. A name's number is the stage: the cycle after the packet's handshake is 1.
//
// The jump over rows above the window uses that the second difference is twice C (`unit`): with q = n C,
// n first + n (n - 1) / 2 second = n (first + q - C), exactly modulo 2^64; and first is C plus what C dy gives.
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
  localparam PEAK = splatline_pkg::PEAK + 4;
  localparam COLOUR = 3 * (splatline_pkg::COLOUR + 4);
  localparam STAGES = 19;
  // Splats from packet to row generator: more than the stages and the queue's own hold, so that a splat a cycle goes through.
  localparam PLACES = 32;
  // Slack on the cut-off that makes spans conservative: 2^-10 in Q.52.
  localparam [55:0] SLACK = 56'd1 << 42;
  // Bits of a distance between a row and a centre.
  localparam CENTRE = $bits(footprint.centre_v);
  localparam DY = (CENTRE > 17 + SUBPIXEL ? CENTRE : 17 + SUBPIXEL) + 1;

  function automatic logic signed [15:0] extend(input logic [9:0] exponent);
    extend = {{6{exponent[9]}}, exponent};
  endfunction

  logic taken;
  assign taken = footprint_valid && footprint_ready;
  logic [STAGES:1] valid;
  always_ff @(posedge clk)
    if (rst) valid <= 0;
    else valid <= {valid[STAGES-1:1], taken};

  // Stage 1: the footprint. What only the rows need waits for stage 17.
  splatline_pkg::footprint_t f1;
  logic [15:0] first_row17, last_row17, box_first17, box_last17;
  logic [31:0] cutoff17;
  logic [PEAK-1:0] peak17;
  logic [COLOUR-1:0] colours17;
  logic [M-1:0] spread17, curvature17;
  logic [9:0] spread_exponent17;
  always_ff @(posedge clk) f1 <= footprint;
  delay #(
      .BITS(64 + 32 + PEAK + COLOUR + 2 * M + 10),
      .STAGES(16)
  ) hold_footprint (
      .clk,
      .rst,
      .advance(1'b1),
      .in({f1.first_row, f1.last_row, f1.first_column, f1.last_column, f1.cutoff, f1.peak, f1.red, f1.green, f1.blue, f1.spread_mantissa, f1.curvature_mantissa, f1.spread_exponent}),
      .out({first_row17, last_row17, box_first17, box_last17, cutoff17, peak17, colours17, spread17, curvature17, spread_exponent17})
  );

  // Stage 2: the first visible row; the distance of its sample points from the centre, Q.subpixel. Stage 3: that as a magnitude.
  logic [15:0] row2, first_row2, skipped3, skipped5, skipped6, skipped16;
  logic signed [DY-1:0] dy2;
  logic dy_negative3;
  logic [DY-1:0] dy3;
  logic slope_negative2, slope_negative6;
  logic [M-1:0] slope2, slope6;
  logic signed [15:0] slope_exponent2, slope_exponent6;
  always_ff @(posedge clk) begin
    row2 <= f1.first_row > window.first_row ? f1.first_row : window.first_row;
    first_row2 <= f1.first_row;
    skipped3 <= row2 - first_row2;
    dy2 <= DY'($signed({1'b0, f1.first_row, 1'b1, {(SUBPIXEL - 1) {1'b0}}})) - DY'($signed(f1.centre_v));
    dy_negative3 <= dy2 < 0;
    dy3 <= dy2 < 0 ? -dy2 : dy2;
    slope_negative2 <= f1.slope_mantissa < 0;
    slope2 <= f1.slope_mantissa < 0 ? M'(-f1.slope_mantissa) : M'(f1.slope_mantissa);
    slope_exponent2 <= extend(f1.slope_exponent);
  end
  delay #(.BITS(16), .STAGES(2)) hold_skipped5 (.clk, .rst, .advance(1'b1), .in(skipped3), .out(skipped5));
  delay #(.BITS(16), .STAGES(1)) hold_skipped6 (.clk, .rst, .advance(1'b1), .in(skipped5), .out(skipped6));
  delay #(.BITS(16), .STAGES(10)) hold_skipped16 (.clk, .rst, .advance(1'b1), .in(skipped6), .out(skipped16));
  delay #(.BITS(M + 17), .STAGES(4)) hold_slope (.clk, .rst, .advance(1'b1), .in({slope_negative2, slope2, slope_exponent2}), .out({slope_negative6, slope6, slope_exponent6}));

  // C and S in fixed point: stages 5 and 6. C at RADIAL + GUARD bits for the seeds: stage 5.
  logic signed [63:0] unit5, slope_fixed6, fine5;
  align #(.BITS(M)) align_unit (.clk, .negative(1'b0), .magnitude(f1.stretch_mantissa), .shift(16'(-extend(f1.stretch_exponent) - 16'sd52)), .result(unit5));
  align #(.BITS(M)) align_slope (.clk, .negative(slope_negative2), .magnitude(slope2), .shift(-slope_exponent2 - 16'sd32), .result(slope_fixed6));
  align #(.BITS(M)) align_fine (.clk, .negative(1'b0), .magnitude(f1.curvature_mantissa), .shift(16'(-extend(f1.curvature_exponent) - 16'(RADIAL + GUARD))), .result(fine5));

  // Stage 6: dy as mantissa and exponent. Stage 8: C dy and S dy.
  logic dy_negative6, dy_negative8;
  logic [M-1:0] dy6, dy11, stretch6;
  logic signed [15:0] dy_exponent6, dy_exponent11, stretch_exponent6;
  normalise #(.BITS(DY)) normalise_dy (.clk, .negative(dy_negative3), .magnitude(dy3), .exponent(16'(-SUBPIXEL)), .result_negative(dy_negative6), .result(dy6), .result_exponent(dy_exponent6));
  delay #(.BITS(M), .STAGES(5)) hold_stretch (.clk, .rst, .advance(1'b1), .in(f1.stretch_mantissa), .out(stretch6));
  delay #(.BITS(16), .STAGES(5)) hold_stretch_exponent (.clk, .rst, .advance(1'b1), .in(extend(f1.stretch_exponent)), .out(stretch_exponent6));
  delay #(.BITS(M + 16), .STAGES(5)) hold_dy (.clk, .rst, .advance(1'b1), .in({dy6, dy_exponent6}), .out({dy11, dy_exponent11}));
  logic [2*M-1:0] along8, shear8;
  multiply #(.LEFT(M), .RIGHT(M)) multiply_along (.clk, .advance(1'b1), .left(stretch6), .right(dy6), .product(along8));
  multiply #(.LEFT(M), .RIGHT(M)) multiply_shear (.clk, .advance(1'b1), .left(slope6), .right(dy6), .product(shear8));
  logic signed [15:0] along_exponent7, along_exponent8, shear_shift7, shear_shift8;
  logic dy_negative7, shear_negative7, shear_negative8;
  always_ff @(posedge clk) begin
    along_exponent7 <= stretch_exponent6 + dy_exponent6;
    along_exponent8 <= along_exponent7;
    shear_shift7 <= -(slope_exponent6 + dy_exponent6) - 16'sd32;
    shear_shift8 <= shear_shift7;
    dy_negative7 <= dy_negative6;
    dy_negative8 <= dy_negative7;
    shear_negative7 <= dy_negative6 != slope_negative6;
    shear_negative8 <= shear_negative7;
  end

  // Stage 13: the first visible row's centre, Q.32.
  logic signed [63:0] shear12, jump_slope8, base8, centre9, centre12, centre13, centre19;
  logic [CENTRE-1:0] centre_u8;
  logic [79:0] jump_slope_wide8;
  align #(.BITS(2 * M)) align_shear (.clk, .negative(shear_negative8), .magnitude(shear8), .shift(shear_shift8), .result(shear12));
  multiply #(.LEFT(64), .RIGHT(16)) multiply_jump_slope (.clk, .advance(1'b1), .left(slope_fixed6), .right(skipped6), .product(jump_slope_wide8));
  delay #(.BITS(CENTRE), .STAGES(7)) hold_centre_u (.clk, .rst, .advance(1'b1), .in(f1.centre_u), .out(centre_u8));
  assign jump_slope8 = $signed(jump_slope_wide8[63:0]);
  assign base8 = (64'($signed(centre_u8)) <<< (32 - SUBPIXEL)) - (64'sd1 <<< 31);
  always_ff @(posedge clk) begin
    centre9 <= base8 + jump_slope8;
    centre13 <= centre12 + shear12;
  end
  delay #(.BITS(64), .STAGES(3)) hold_centre12 (.clk, .rst, .advance(1'b1), .in(centre9), .out(centre12));
  delay #(.BITS(64), .STAGES(6)) hold_centre19 (.clk, .rst, .advance(1'b1), .in(centre13), .out(centre19));
  logic signed [63:0] slope19;
  delay #(.BITS(64), .STAGES(13)) hold_slope19 (.clk, .rst, .advance(1'b1), .in(slope_fixed6), .out(slope19));

  // Stage 11: C dy rounded to a mantissa. Stage 15: in Q.52, twice: what the first difference has beside C.
  logic along_negative11;
  logic [M-1:0] along11;
  logic signed [15:0] along_exponent11;
  logic signed [63:0] double15, unit15, jump_unit15, unit19;
  logic [79:0] jump_unit_wide7;
  normalise #(.BITS(2 * M)) normalise_along (.clk, .negative(dy_negative8), .magnitude(along8), .exponent(along_exponent8), .result_negative(along_negative11), .result(along11), .result_exponent(along_exponent11));
  align #(.BITS(M)) align_double (.clk, .negative(along_negative11), .magnitude(along11), .shift(-along_exponent11 - 16'sd53), .result(double15));
  multiply #(.LEFT(64), .RIGHT(16)) multiply_jump_unit (.clk, .advance(1'b1), .left(unit5), .right(skipped5), .product(jump_unit_wide7));
  delay #(.BITS(64), .STAGES(8)) hold_jump_unit (.clk, .rst, .advance(1'b1), .in(jump_unit_wide7[63:0]), .out(jump_unit15));
  delay #(.BITS(64), .STAGES(10)) hold_unit15 (.clk, .rst, .advance(1'b1), .in(unit5), .out(unit15));
  delay #(.BITS(64), .STAGES(4)) hold_unit19 (.clk, .rst, .advance(1'b1), .in(unit15), .out(unit19));

  // Stage 17: C dy^2 in the box's first row, Q.52; C and dy have one sign. Stages 16 to 19: the jump.
  logic [2*M-1:0] square13;
  logic signed [15:0] square_shift12, square_shift13;
  logic signed [63:0] vertical17, vertical18, vertical19, first16, mean16, first17, first19, jump_unit16;
  logic [79:0] jump_wide18;
  multiply #(.LEFT(M), .RIGHT(M)) multiply_square (.clk, .advance(1'b1), .left(along11), .right(dy11), .product(square13));
  align #(.BITS(2 * M)) align_vertical (.clk, .negative(1'b0), .magnitude(square13), .shift(square_shift13), .result(vertical17));
  multiply #(.LEFT(64), .RIGHT(16)) multiply_jump (.clk, .advance(1'b1), .left(mean16), .right(skipped16), .product(jump_wide18));
  always_ff @(posedge clk) begin
    square_shift12 <= -(along_exponent11 + dy_exponent11) - 16'sd52;
    square_shift13 <= square_shift12;
    first16 <= double15 + unit15;
    mean16 <= double15 + jump_unit15;
    jump_unit16 <= jump_unit15;
    first17 <= first16 + (jump_unit16 <<< 1);
    vertical18 <= vertical17;
    vertical19 <= vertical18 + $signed(jump_wide18[63:0]);
  end
  delay #(.BITS(64), .STAGES(2)) hold_first (.clk, .rst, .advance(1'b1), .in(first17), .out(first19));

  // `Seed::new`: unit of dx and the alignments that follow from it, constants of the footprint.
  logic [6:0] spread_length2;
  logic signed [15:0] spread_exponent2, leading3, half4, drop_wide5, drop6, power7, curvature_exponent6, drop_radial8, drop_first8, drop7;
  logic [5:0] drop_dx19;
  logic signed [15:0] drop_radial19, drop_first19;
  delay #(.BITS(16), .STAGES(5)) hold_curvature_exponent (.clk, .rst, .advance(1'b1), .in(extend(f1.curvature_exponent)), .out(curvature_exponent6));
  always_ff @(posedge clk) begin
    spread_length2 <= splatline_math::length(64'(f1.spread_mantissa));
    spread_exponent2 <= extend(f1.spread_exponent);
    leading3 <= spread_exponent2 + $signed({9'd0, spread_length2}) + 16'sd5;
    half4 <= leading3 >>> 1;
    drop_wide5 <= half4 + 16'sd32 - $signed(16'(M));
    drop6 <= drop_wide5 < 0 ? 16'sd0 : drop_wide5 > 63 ? 16'sd63 : drop_wide5;
    power7 <= curvature_exponent6 + drop6;
    drop7 <= drop6;
    drop_radial8 <= 16'sd64 - $signed(16'(M)) - $signed(16'(RADIAL)) - power7 - drop7;
    drop_first8 <= 16'sd31 - $signed(16'(RADIAL)) - power7;
  end
  delay #(.BITS(32), .STAGES(11)) hold_drops (.clk, .rst, .advance(1'b1), .in({drop_radial8, drop_first8}), .out({drop_radial19, drop_first19}));
  delay #(.BITS(6), .STAGES(12)) hold_drop_dx (.clk, .rst, .advance(1'b1), .in(drop7[5:0]), .out(drop_dx19));

  // `Balance::new`. The second difference keeps 32 bits; what its rounding leaves is less than a unit.
  logic signed [47:0] fine6;
  logic signed [47:0] second6, balanced8, start8;
  logic signed [GUARD:0] excess7;
  logic signed [47:0] rounded7, second7, second8;
  logic [31:0] second19, unit_balanced19, balance19;
  logic [47:0] balanced9, start9, second9;
  localparam signed [47:0] BALANCE_HALF = 48'sd1 <<< (GUARD - 1);
  always_ff @(posedge clk) begin
    fine6 <= 48'(fine5);
    second6 <= 48'(splatline_math::shift_round(fine5, 7'(GUARD - 1)));
    excess7 <= (GUARD + 1)'((second6 <<< (GUARD - 1)) - fine6);
    rounded7 <= second6 <<< (GUARD - 1);
    second7 <= second6;
    balanced8 <= rounded7 - (48'(excess7) <<< BLOCK_BITS);
    start8 <= (48'(excess7) <<< (2 * BLOCK_BITS - 3)) + BALANCE_HALF;
    second8 <= second7;
    balanced9 <= (balanced8 + BALANCE_HALF) >>> GUARD;
    start9 <= start8 >>> GUARD;
    second9 <= second8;
  end
  delay #(.BITS(96), .STAGES(10)) hold_balance (.clk, .rst, .advance(1'b1), .in({second9[31:0], balanced9[31:0], start9[31:0]}), .out({second19, unit_balanced19, balance19}));

  // Stage 18: what is visible. Stage 19: how many rows; none, if the window holds none of the box's columns.
  logic [15:0] row18, last_row18, first_column18, last_column18, box_first18, box_last18, row19, rows19, first_column19, last_column19, box_first19, box_last19;
  logic [31:0] cutoff18;
  logic [32:0] cutoff_half18;
  logic [PEAK-1:0] peak18, peak19;
  logic [COLOUR-1:0] colours18, colours19;
  logic [M-1:0] spread18, curvature18, spread19, curvature19;
  logic [9:0] spread_exponent18;
  logic [55:0] reach19;
  logic [RADIAL+4:0] cutoff19;
  logic spread_odd19;
  logic signed [15:0] spread_power19;
  assign cutoff_half18 = RADIAL == 28 ? {1'b0, cutoff18} : {1'b0, cutoff18} + (33'd1 << (27 - RADIAL));
  always_ff @(posedge clk) begin
    row18 <= first_row17 > window.first_row ? first_row17 : window.first_row;
    last_row18 <= last_row17 < window.last_row ? last_row17 : window.last_row;
    first_column18 <= box_first17 > window.first_column ? box_first17 : window.first_column;
    last_column18 <= box_last17 < window.last_column ? box_last17 : window.last_column;
    box_first18 <= box_first17;
    box_last18 <= box_last17;
    cutoff18 <= cutoff17;
    peak18 <= peak17;
    colours18 <= colours17;
    spread18 <= spread17;
    curvature18 <= curvature17;
    spread_exponent18 <= spread_exponent17;

    row19 <= row18;
    rows19 <= first_column18 < last_column18 && row18 < last_row18 ? last_row18 - row18 : 16'd0;
    first_column19 <= first_column18;
    last_column19 <= last_column18;
    box_first19 <= box_first18;
    box_last19 <= box_last18;
    reach19 <= {cutoff18, 24'd0} + SLACK;
    cutoff19 <= (RADIAL + 5)'(cutoff_half18 >> (28 - RADIAL));
    peak19 <= peak18;
    colours19 <= colours18;
    spread19 <= spread18;
    curvature19 <= curvature18;
    spread_odd19 <= spread_exponent18[0];
    spread_power19 <= (extend(spread_exponent18) >>> 1) + 16'sd18;
  end

  // The fields in the order of `start_t` and `shape_t`.
  
  fifo #(
      .BITS($bits(start) + $bits(shape)),
      .PLACES(PLACES)
  ) splats (
      .clk,
      .rst,
      .claim(taken),
      .free(footprint_ready),
      .none(idle),
      .in_valid(valid[STAGES]),
      .in({
        row19,
        rows19,
        centre19,
        slope19,
        vertical19,
        first19,
        unit19 <<< 1,
        box_first19,
        box_last19,
        first_column19,
        last_column19,
        reach19,
        spread19,
        spread_odd19,
        spread_power19,
        curvature19,
        drop_dx19,
        drop_radial19,
        drop_first19,
        second19,
        unit_balanced19,
        balance19,
        cutoff19,
        peak19,
        colours19
      }),
      .out_valid(splat_valid),
      .out_ready(splat_ready),
      .out({start, shape})
  );
endmodule
