// From a footprint to its first visible row: `EllipseSpans::new` of src/raster/spans.rs as a pipeline of 24 stages, one
// splat in INTERVAL cycles.
//
// With an interval of 4 or 8 stages take turns at three products, an alignment (two with 4) and a normalisation
// (turn.sv), which costs nothing where splats have as many rows and more. Then packets are taken in every fourth or
// eighth cycle since the reset and in no other, so that no two stages ever want the same turn.
//
// Stages never stand still. What is ready waits in a queue, and a packet is only taken if there is a place for it, so
// that no signal has to reach every register of the unit within a cycle. Nor does what is ready early travel along: it
// goes into its place of the queue in five parts. A name's number is the stage: the cycle after the packet's handshake
// is 1.
//
// The rows' seed is that of their block, as the columns' is, so a window begins with the first row and column of one
// (`RowSeeds::at`).
module splat_setup #(
    parameter INTERVAL = 4
) (
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
  localparam E = splatline_pkg::EXPONENT;
  localparam SUBPIXEL = splatline_pkg::SUBPIXEL;
  localparam RADIAL = splatline_pkg::RADIAL;
  localparam VERTICAL = splatline_pkg::VERTICAL;
  localparam GUARD = splatline_pkg::GUARD;
  localparam PEAK = splatline_pkg::PEAK + 4;
  localparam COLOUR = 3 * splatline_pkg::COLOUR_BITS;
  localparam STAGES = 24;
  // Splats from packet to row generator: more than the stages and the queue's own hold, so that a splat a cycle goes
  // through.
  localparam PLACES = 32;
  // Bits of C dy^2, and the slack on the cut-off that makes spans conservative: 2^-10.
  localparam ROW = VERTICAL + 6;
  localparam [ROW-2:0] SLACK = (ROW - 1)'(1) << (VERTICAL - 10);
  // Bits of a centre; fraction bits of xc, where its steps are small and where they are large.
  localparam CENTRE = $bits(footprint.centre_v);
  localparam FINE = SUBPIXEL + 8;
  localparam COARSE = SUBPIXEL - 2;
  // xc before it is cut to its word: S dy is below 2^28 pixels.
  localparam WIDE = FINE + 31;
  // Bits of a distance between a row and a centre.
  localparam DY = (CENTRE > 17 + SUBPIXEL ? CENTRE : 17 + SUBPIXEL) + 1;

  function automatic logic signed [E-1:0] extend(input logic [9:0] exponent);
    extend = {{(E - 10) {exponent[9]}}, exponent};
  endfunction

  // Of an interval of 8, wide mantissas have one multiplier for all three products. Then S dy waits a cycle for C dy,
  // and the alignments of S dy and A change places.
  localparam SHARED = INTERVAL == 8 && M > 18;
  localparam LATE = SHARED ? 1 : 0;

  // Cycles since the reset: with an interval, whose turn it is.
  logic taken, place, due;
  logic [2:0] phase;
  assign footprint_ready = place && due;
  assign taken = footprint_valid && footprint_ready;
  logic [STAGES:1] valid;
  always_ff @(posedge clk) begin
    if (rst) valid <= 0;
    else valid <= {valid[STAGES-1:1], taken};
    if (rst) begin
      phase <= 0;
      due <= 1;
    end else begin
      phase <= phase + 3'd1;
      due <= (phase & 3'(INTERVAL - 1)) == 3'(INTERVAL - 1);
    end
  end

  // Stage 1: the footprint.
  splatline_pkg::footprint_t f1;
  always_ff @(posedge clk) f1 <= footprint;

  // Stage 1: the first row of the block, or of the box. Stage 2: the distance of its sample points from the centre,
  // Q.subpixel. Stage 3: that as a magnitude.
  logic [15:0] row1;
  logic signed [DY-1:0] dy2;
  logic dy_negative3;
  logic [DY-1:0] dy3;
  logic shear_negative2, shear_negative5, shear_negative7;
  logic [M-1:0] shear2, shear5, shear7;
  logic signed [E-1:0] shear_exponent2, shear_exponent4, shear_exponent7, shear_shift5;
  always_ff @(posedge clk) begin
    row1 <= footprint.first_row > window.first_row ? footprint.first_row : window.first_row;
    dy2 <= DY'($signed({1'b0, row1, 1'b1, {(SUBPIXEL - 1) {1'b0}}})) - DY'($signed(f1.centre_v));
    dy_negative3 <= dy2 < 0;
    dy3 <= dy2 < 0 ? -dy2 : dy2;
    shear_negative2 <= f1.shear_mantissa < 0;
    shear2 <= f1.shear_mantissa < 0 ? M'(-f1.shear_mantissa) : M'(f1.shear_mantissa);
    shear_exponent2 <= extend(f1.shear_exponent);
  end
  delay #(.BITS(M + 1), .STAGES(3)) hold_shear5 (.clk, .rst, .advance(1'b1), .in({shear_negative2, shear2}), .out({shear_negative5, shear5}));
  delay #(.BITS(M + 1), .STAGES(2)) hold_shear7 (.clk, .rst, .advance(1'b1), .in({shear_negative5, shear5}), .out({shear_negative7, shear7}));
  delay #(.BITS(E), .STAGES(2)) hold_shear_exponent4 (.clk, .rst, .advance(1'b1), .in(shear_exponent2), .out(shear_exponent4));
  delay #(.BITS(E), .STAGES(3)) hold_shear_exponent7 (.clk, .rst, .advance(1'b1), .in(shear_exponent4), .out(shear_exponent7));

  // Stage 4: does xc take large steps, or dx large values (`centre_fraction`)? Then it has fewer fraction bits.
  logic far3, coarse4, coarse7, coarse12, coarse13;
  logic signed [E-1:0] leading3;
  function automatic logic signed [E-1:0] fraction(input logic coarse);
    fraction = coarse ? E'(COARSE) : E'(FINE);
  endfunction
  always_ff @(posedge clk) begin
    far3 <= shear2 != 0 && shear_exponent2 > E'(13) - E'(M);
    coarse4 <= far3 || (leading3 >>> 1) > E'(13);
    shear_shift5 <= -shear_exponent4 - fraction(coarse4);
  end
  delay #(.BITS(1), .STAGES(3)) hold_coarse7 (.clk, .rst, .advance(1'b1), .in(coarse4), .out(coarse7));
  delay #(.BITS(1), .STAGES(5)) hold_coarse12 (.clk, .rst, .advance(1'b1), .in(coarse7), .out(coarse12));
  always_ff @(posedge clk) coarse13 <= coarse12;

  // Alignments: to A at RADIAL + GUARD bits for the seeds (from stage 3, SHARED 2), S (5), C with GUARD bits (8) and
  // S dy (10, SHARED 11) in fixed point; and to C dy, doubled (14), and C dy^2 (17).
  logic [M-1:0] horizontal2, horizontal3, vertical7, vertical8, along14;
  logic signed [E-1:0] horizontal_exponent2, horizontal_exponent3, horizontal_shift, moved_shift, vertical_exponent7, vertical_exponent8, moved_shift10, along_exponent14, square_shift17;
  logic [2*M-1:0] moved, square17;
  logic moved_negative10, moved_negative, along_negative14;
  logic signed [63:0] fine8, shear_fixed10, fine13, aligned2, aligned3, aligned_moved, double19, vertical22;
  logic [127:0] spare_alignments;
  delay #(.BITS(M + E), .STAGES(1)) hold_horizontal2 (.clk, .rst, .advance(1'b1), .in({f1.horizontal_mantissa, extend(f1.horizontal_exponent)}), .out({horizontal2, horizontal_exponent2}));
  delay #(.BITS(M + E), .STAGES(1)) hold_horizontal3 (.clk, .rst, .advance(1'b1), .in({horizontal2, horizontal_exponent2}), .out({horizontal3, horizontal_exponent3}));
  assign horizontal_shift = -(SHARED ? horizontal_exponent2 : horizontal_exponent3) - E'(RADIAL + GUARD);
  delay #(.BITS(M + E), .STAGES(6)) hold_vertical7 (.clk, .rst, .advance(1'b1), .in({f1.vertical_mantissa, extend(f1.vertical_exponent)}), .out({vertical7, vertical_exponent7}));
  delay #(.BITS(M + E), .STAGES(1)) hold_vertical8 (.clk, .rst, .advance(1'b1), .in({vertical7, vertical_exponent7}), .out({vertical8, vertical_exponent8}));
  // Stage 5 has place 1 and stage 17 place 5, so that either unit of an interval of 4 has a cycle for all that is its
  // own; with 8, phases 1 and 5 stand for each other here.
  logic [2:0] align_phase;
  assign align_phase = {phase[2] != (phase[1:0] == 2'd1), phase[1:0]};
  shared_align #(
      .BITS(2 * M),
      .INTERVAL(INTERVAL),
      .USED(8'b01101111)
  ) align_all (
      .clk,
      .phase(align_phase),
      .negative({1'b0, along_negative14, 2'b00, SHARED && moved_negative, !SHARED && moved_negative, shear_negative5, 1'b0}),
      .magnitude({
        (2 * M)'(0),
        (2 * M)'(along14),
        square17,
        (2 * M)'(0),
        SHARED ? {moved, (2 * M)'(horizontal2)} : {(2 * M)'(horizontal3), moved},
        (2 * M)'(shear5),
        (2 * M)'(vertical8)
      }),
      .shift({
        E'(0),
        E'(-along_exponent14 - E'(VERTICAL + 1)),
        square_shift17,
        E'(0),
        SHARED ? {moved_shift, horizontal_shift} : {horizontal_shift, moved_shift},
        shear_shift5,
        E'(-vertical_exponent8 - E'(VERTICAL + GUARD))
      }),
      .result({spare_alignments[127:64], double19, vertical22, spare_alignments[63:0], aligned3, aligned2, shear_fixed10, fine13})
  );
  assign aligned_moved = SHARED ? aligned3 : aligned2;
  delay #(.BITS(64), .STAGES(LATE)) hold_fine8 (.clk, .rst, .advance(1'b1), .in(SHARED ? aligned2 : aligned3), .out(fine8));

  // Normalisations: of dy (from stage 3) and of C dy (10).
  localparam NORMAL = DY > 2 * M ? DY : 2 * M;
  logic dy_negative7;
  logic [M-1:0] dy7, dy14;
  logic signed [E-1:0] dy_exponent7, dy_exponent14, along_exponent10;
  logic dy_negative10;
  logic [2*M-1:0] along10;
  logic [5:0] spare_negatives;
  logic [6*M-1:0] spare_mantissas;
  logic [6*E-1:0] spare_exponents;
  shared_normalise #(
      .BITS(NORMAL),
      .INTERVAL(INTERVAL),
      .USED(8'b00001100)
  ) normalise_both (
      .clk,
      .phase,
      .negative({4'd0, dy_negative3, dy_negative10, 2'd0}),
      .magnitude({(4 * NORMAL)'(0), NORMAL'(dy3), NORMAL'(along10), (2 * NORMAL)'(0)}),
      .exponent({(4 * E)'(0), E'(-SUBPIXEL), along_exponent10, (2 * E)'(0)}),
      .result_negative({spare_negatives[5:2], dy_negative7, along_negative14, spare_negatives[1:0]}),
      .result({spare_mantissas[6*M-1:2*M], dy7, along14, spare_mantissas[2*M-1:0]}),
      .result_exponent({spare_exponents[6*E-1:2*E], dy_exponent7, along_exponent14, spare_exponents[2*E-1:0]})
  );
  delay #(.BITS(M + E), .STAGES(7)) hold_dy (.clk, .rst, .advance(1'b1), .in({dy7, dy_exponent7}), .out({dy14, dy_exponent14}));

  // Products of mantissas: C dy (from stage 7), C dy dy (14), and beside them S dy (7), SHARED in the same unit (8).
  logic [M-1:0] shear8, dy8;
  logic [2*M-1:0] shared_moved;
  logic [10*M-1:0] spare_squares;
  always_ff @(posedge clk) begin
    shear8 <= shear7;
    dy8 <= dy7;
  end
  shared_multiply #(
      .LEFT(M),
      .RIGHT(M),
      .INTERVAL(INTERVAL),
      .USED(8'b11000000 | 8'(SHARED))
  ) multiply_mantissas (
      .clk,
      .phase,
      .left({vertical7, along14, (5 * M)'(0), {M{SHARED}} & shear8}),
      .right({dy7, dy14, (5 * M)'(0), {M{SHARED}} & dy8}),
      .product({along10, square17, spare_squares, shared_moved})
  );
  generate
    if (SHARED) begin : gen_shared
      assign moved = shared_moved;
    end else begin : gen_moved
      multiply #(.LEFT(M), .RIGHT(M)) multiply_moved (.clk, .advance(1'b1), .left(shear8), .right(dy8), .low(), .product(moved));
    end
  endgenerate
  delay #(.BITS(E + 1), .STAGES(LATE)) hold_moved (.clk, .rst, .advance(1'b1), .in({moved_shift10, moved_negative10}), .out({moved_shift, moved_negative}));
  logic signed [E-1:0] along_exponent8, along_exponent9, moved_shift8, moved_shift9, square_shift15, square_shift16;
  logic dy_negative8, dy_negative9, moved_negative8, moved_negative9;
  always_ff @(posedge clk) begin
    along_exponent8 <= vertical_exponent7 + dy_exponent7;
    along_exponent9 <= along_exponent8;
    along_exponent10 <= along_exponent9;
    moved_shift8 <= -(shear_exponent7 + dy_exponent7) - fraction(coarse7);
    moved_shift9 <= moved_shift8;
    moved_shift10 <= moved_shift9;
    dy_negative8 <= dy_negative7;
    dy_negative9 <= dy_negative8;
    dy_negative10 <= dy_negative9;
    moved_negative8 <= dy_negative7 != shear_negative7;
    moved_negative9 <= moved_negative8;
    moved_negative10 <= moved_negative9;
    square_shift15 <= -(along_exponent14 + dy_exponent14) - E'(VERTICAL);
    square_shift16 <= square_shift15;
    square_shift17 <= square_shift16;
  end

  // Stage 16, with SHARED 17: xc - 1/2 of the first row. The stage after it: cut to its word, of which no row that
  // meets the window gets near the ends.
  logic signed [WIDE-1:0] base14, base15, base, sum, centre_u13;
  logic signed [CENTRE-1:0] centre, shear12;
  logic [CENTRE-1:0] centre_u12;
  localparam signed [WIDE-1:0] PIXEL_HALF = WIDE'(1) << (SUBPIXEL - 1);
  delay #(.BITS(CENTRE), .STAGES(11)) hold_centre_u (.clk, .rst, .advance(1'b1), .in(f1.centre_u), .out(centre_u12));
  always_ff @(posedge clk) begin
    centre_u13 <= WIDE'($signed(centre_u12)) - PIXEL_HALF;
    base14 <= coarse13 ? (centre_u13 + WIDE'(2)) >>> 2 : centre_u13 <<< 8;
    base15 <= base14;
    sum <= base + WIDE'(aligned_moved);
    centre <= sum[WIDE-1:CENTRE-1] == {(WIDE - CENTRE + 1) {sum[WIDE-1]}} ? CENTRE'(sum) : {sum[WIDE-1], {(CENTRE - 1) {!sum[WIDE-1]}}};
  end
  delay #(.BITS(WIDE), .STAGES(LATE)) hold_base (.clk, .rst, .advance(1'b1), .in(base15), .out(base));
  delay #(.BITS(CENTRE), .STAGES(2)) hold_shear12 (.clk, .rst, .advance(1'b1), .in(shear_fixed10[CENTRE-1:0]), .out(shear12));

  // Stage 20: the first difference of C dy^2. Stage 23: C dy^2.
  logic [ROW-1:0] curve17, curve, unit17, unit19, start17, start22, first20, vertical23, vertical24;
  seed_balance #(.BITS(ROW)) balance_rows (.clk, .fine(fine13), .second(curve17), .unit(unit17), .start(start17));
  delay #(.BITS(ROW), .STAGES(LATE)) hold_curve (.clk, .rst, .advance(1'b1), .in(curve17), .out(curve));
  delay #(.BITS(ROW), .STAGES(2)) hold_unit (.clk, .rst, .advance(1'b1), .in(unit17), .out(unit19));
  delay #(.BITS(ROW), .STAGES(5)) hold_start (.clk, .rst, .advance(1'b1), .in(start17), .out(start22));
  always_ff @(posedge clk) begin
    first20 <= ROW'(double19) + unit19;
    vertical23 <= ROW'(vertical22) + start22;
    vertical24 <= vertical23;
  end
  // Stages that do not exist.
  logic unused;
  assign unused = &{1'b0, spare_alignments, spare_negatives, spare_mantissas, spare_exponents, spare_squares, shared_moved, aligned_moved};

  // `Seed::new`: unit of dx and the alignments that follow from it, constants of the footprint.
  logic [6:0] squared_width_length2;
  logic signed [E-1:0] squared_width_exponent2, half4, drop_wide5, drop6, power7, horizontal_exponent6, drop_first8;
  logic [5:0] drop_dx12;
  logic signed [E-1:0] drop_first12;
  delay #(.BITS(E), .STAGES(5)) hold_horizontal_exponent (.clk, .rst, .advance(1'b1), .in(extend(f1.horizontal_exponent)), .out(horizontal_exponent6));
  always_ff @(posedge clk) begin
    squared_width_length2 <= splatline_math::length(64'(f1.squared_width_mantissa));
    squared_width_exponent2 <= extend(f1.squared_width_exponent);
    leading3 <= squared_width_exponent2 + E'($signed({1'b0, squared_width_length2})) + E'(5);
    half4 <= leading3 >>> 1;
    drop_wide5 <= half4 + fraction(coarse4) - $signed(E'(M));
    drop6 <= drop_wide5 < 0 ? E'(0) : drop_wide5 > 63 ? E'(63) : drop_wide5;
    power7 <= horizontal_exponent6 + drop6;
    drop_first8 <= fraction(coarse7) - E'(1) - $signed(E'(RADIAL)) - power7;
  end
  delay #(.BITS(E), .STAGES(4)) hold_drop_first (.clk, .rst, .advance(1'b1), .in(drop_first8), .out(drop_first12));
  delay #(.BITS(6), .STAGES(6)) hold_drop_dx (.clk, .rst, .advance(1'b1), .in(drop6[5:0]), .out(drop_dx12));

  logic [31:0] second12, unit_balanced12, balance12;
  seed_balance balance_lanes (.clk, .fine(fine8), .second(second12), .unit(unit_balanced12), .start(balance12));

  // Stages 2 and 3: what is visible, and how many rows; the footprint's other words as rows and lanes take them.
  logic [splatline_pkg::TILE_ROW_BITS-1:0] row3;
  logic [splatline_pkg::TILE_ROW_BITS:0] rows3;
  logic [15:0] end_column3, start_column3;
  visible_box visible (.clk, .window, .first_row1(f1.first_row), .end_row1(f1.end_row), .box_first1(f1.first_column), .box_end1(f1.end_column), .row3, .rows3, .start_column3, .end_column3);
  logic [31:0] cutoff2;
  logic [32:0] cutoff_half2;
  logic [PEAK-1:0] peak2, peak3;
  logic [COLOUR-1:0] colours2, colours3;
  logic [M-1:0] squared_width2, squared_width3;
  logic [ROW-2:0] reach3;
  logic [RADIAL+4:0] cutoff3;
  logic squared_width_odd3, squared_width_odd12;
  logic [M-1:0] horizontal12;
  logic signed [E-1:0] squared_width_power3;
  // From UQ4.28, halves up.
  function automatic logic [ROW-2:0] reach_of(input logic [31:0] cutoff);
    reach_of = (ROW - 1)'(((64'(cutoff) << VERTICAL) + (64'd1 << 27)) >> 28);
  endfunction
  assign cutoff_half2 = RADIAL == 28 ? {1'b0, cutoff2} : {1'b0, cutoff2} + (33'd1 << (27 - RADIAL));
  always_ff @(posedge clk) begin
    cutoff2 <= f1.cutoff;
    peak2 <= f1.peak;
    colours2 <= {f1.red, f1.green, f1.blue};
    squared_width2 <= f1.squared_width_mantissa;

    reach3 <= reach_of(cutoff2) + SLACK;
    cutoff3 <= (RADIAL + 5)'(cutoff_half2 >> (28 - RADIAL));
    peak3 <= peak2;
    colours3 <= colours2;
    squared_width3 <= squared_width2;
    squared_width_odd3 <= squared_width_exponent2[0];
    squared_width_power3 <= (squared_width_exponent2 >>> 1) + E'(20);
  end

  // Two words of the first part wait for the second, which has bits left in its blocks of memory.
  delay #(.BITS(M + 1), .STAGES(9)) hold_horizontal12 (.clk, .rst, .advance(1'b1), .in({horizontal3, squared_width_odd3}), .out({horizontal12, squared_width_odd12}));

  // The splat, in parts as they are ready: in stages 3, 12, 17 (SHARED 18), 20 and 24.
  localparam PART_3 = 2 * splatline_pkg::TILE_ROW_BITS + 1 + 2 * 16 + (ROW - 1) + M + E + (RADIAL + 5) + PEAK + COLOUR;
  localparam PART_12 = PART_3 + CENTRE + 1 + 6 + E + 3 * 32 + M + 1;
  localparam PART_17 = PART_12 + CENTRE + ROW;
  localparam PART_20 = PART_17 + ROW;
  localparam PART_24 = PART_20 + ROW;
  fifo #(
      .BITS(PART_24),
      .PLACES(PLACES),
      .RESTS(1),
      .PARTS(5),
      .ENDS({16'(PART_24), 16'(PART_20), 16'(PART_17), 16'(PART_12), 16'(PART_3)})
  ) splats (
      .clk,
      .rst,
      .claim(taken),
      .free(place),
      .none(idle),
      .in_valid({valid[STAGES], valid[20], valid[17+LATE], valid[12], valid[3]}),
      .in({
        vertical24,
        first20,
        {centre, curve},
        {shear12, coarse12, drop_dx12, drop_first12, second12, unit_balanced12, balance12, horizontal12, squared_width_odd12},
        {row3, rows3, start_column3, end_column3, reach3},
        {squared_width3, squared_width_power3, cutoff3, peak3, colours3}
      }),
      .out_valid(splat_valid),
      .out_ready(splat_ready),
      .out({
        start.vertical,
        start.first,
        {start.centre, start.second},
        {start.shear, shape.coarse, shape.drop_dx, shape.drop_first, shape.second, shape.unit, shape.balance, shape.horizontal, shape.squared_width_odd},
        {start.row, start.rows, shape.start_column, shape.end_column, shape.reach},
        {shape.squared_width, shape.squared_width_power, shape.cutoff, shape.paint}
      }),
      .next()
  );
endmodule
