// The last step of setup: a core's results become a packet, or the reason why there is none.
//
// Its words come in eight cycles, from phase 0 on; two rounds of eight phases later the packet leaves. What needs 64
// bits once for a splat stands here and not in the cores: the comparison with the planes of depth
// (`Extended::exceeds`), the sort key (`depth::key`), the box (`bounding_box`), the fixed-point opacity. Of the conic
// only its exponent counts, since splats without a place for it are culled. The order of the reasons is the kernel's.
//
//   words | depth, opacity, extents | box, reason, packet
module setup_pack (
    input logic clk,
    input logic rst,
    input logic [2:0] phase,
    input logic perspective,
    input logic by_opacity,
    input logic [15:0] columns,
    input logic [15:0] rows,
    input logic near_negative,
    input logic [62:0] near,
    input logic signed [17:0] near_leading,
    input logic far_negative,
    input logic [62:0] far,
    input logic signed [17:0] far_leading,
    input logic valid,  // in phase 0: a splat's words begin
    input logic [splatline_setup_pkg::PAIR_BITS-1:0] word,
    output logic packet_valid,
    output logic packet_taken,  // the colour below is used
    input logic [95:0] colour,  // blue, green, red
    output logic [2:0] cull,
    output logic [47:0] depth,  // the sort key
    output splatline_pkg::footprint_t packet
);
  localparam M = splatline_pkg::MANTISSA;
  localparam DROP = 31 - M;
  localparam SUBPIXEL = splatline_pkg::SUBPIXEL;
  localparam COLOUR = splatline_pkg::COLOUR;

  // Words as they come; the last one stands still in the next round at once.
  logic signed [32:0] word_a, word_b;
  logic signed [17:0] word_a_exponent, word_b_exponent;
  logic signed [63:0] depth0;
  logic [63:0] long_a;
  logic [31:0] u0, v0, high_u0, high_v0;
  logic signed [17:0] depth_exponent0;
  logic signed [31:0] root_u0, root_v0, horizontal0, squared_width0, shear0, vertical0;
  logic signed [17:0] root_u_exponent0, root_v_exponent0, horizontal_exponent0, squared_width_exponent0, shear_exponent0;
  logic signed [17:0] vertical_exponent0, cross_exponent0, conic_exponent0;
  logic signed [32:0] cutoff0;
  logic signed [31:0] peak0;
  logic signed [17:0] peak_exponent0;
  logic valid0, valid1, valid2;
  logic ends;  // phase 7, in a register of its own: it reaches every bit of the words
  assign {word_a, word_a_exponent, word_b, word_b_exponent} = word;
  // A position in one word of which the core took a part for its exponent, or the lower half of one.
  localparam FAINT = splatline_setup_pkg::FAINT;
  generate
    if (FAINT > 0) begin : gen_long
      logic [31-FAINT:0] around;
      assign around = word_a_exponent[31-FAINT:0] - (32 - FAINT)'(FAINT);
      assign long_a = {around[30-FAINT:0], word_a, {(FAINT - 1) {1'b0}}, around[31-FAINT]};
    end else begin : gen_short
      assign long_a = {32'd0, word_a[31:0]};
    end
  endgenerate
  always_ff @(posedge clk) begin
    case (phase)
      3'd0: {depth0, depth_exponent0} <= {word_b[31:0], word_a[31:0], word_a_exponent};
      3'd1: {high_u0, u0, cutoff0} <= {long_a, word_b};
      3'd2: {high_v0, v0, root_u0, root_u_exponent0} <= {long_a, word_b[31:0], word_b_exponent};
      3'd3: {root_v0, root_v_exponent0, horizontal0, horizontal_exponent0} <= {word_a[31:0], word_a_exponent, word_b[31:0], word_b_exponent};
      3'd4: {squared_width0, squared_width_exponent0, shear0, shear_exponent0} <= {word_a[31:0], word_a_exponent, word_b[31:0], word_b_exponent};
      3'd5: {vertical0, vertical_exponent0, cross_exponent0} <= {word_a[31:0], word_a_exponent, word_b_exponent};
      3'd6: {conic_exponent0, peak0, peak_exponent0} <= {word_a_exponent, word_b[31:0], word_b_exponent};
      default: ;
    endcase
    ends <= phase == 3'd6;
    if (rst) {valid0, valid1, valid2} <= 0;
    else begin
      if (phase == 0) valid0 <= valid;
      if (ends) {valid1, valid2} <= {valid0, valid1};
    end
  end

  // The second round of phases: all of a splat's words stand still, and what is computed from them runs through
  // registers.
  logic signed [63:0] u1, v1;
  logic signed [31:0] peak1, root_u1, root_v1, horizontal1, squared_width1, shear1, vertical1;
  logic signed [17:0] peak_exponent1, root_u_exponent1, root_v_exponent1, horizontal_exponent1, squared_width_exponent1;
  logic signed [17:0] shear_exponent1, vertical_exponent1;
  logic signed [32:0] cutoff1;
  always_ff @(posedge clk) begin
    if (ends) begin
      {u1, v1, cutoff1} <= {high_u0, u0, high_v0, v0, cutoff0};
      if (FAINT == 0) {u1[63:32], v1[63:32]} <= {word_a[31:0], word_b[31:0]};
      {peak1, peak_exponent1} <= {peak0, peak_exponent0};
      {root_u1, root_v1, horizontal1, squared_width1, shear1} <= {root_u0, root_v0, horizontal0, squared_width0, shear0};
      vertical1 <= vertical0;
      {root_u_exponent1, root_v_exponent1} <= {root_u_exponent0, root_v_exponent0};
      {horizontal_exponent1, squared_width_exponent1, shear_exponent1} <= {horizontal_exponent0, squared_width_exponent0, shear_exponent0};
      vertical_exponent1 <= vertical_exponent0;
    end
  end

  // Depth: leading bit at bit 62, comparisons, key. Its word comes first, so that a register has eight cycles to move
  // it by bytes, from phase 2 to phase 2 of the second round, and another one as many to move it by bits: one choice
  // for a bit and not six.
  logic [62:0] depth_magnitude, depth_coarse, depth_fine, depth_normal;
  logic [2:0] bytes, kept_bytes, ones;
  logic depth_negative1, depth_negative2, depth_negative;
  logic signed [17:0] depth_exponent1, depth_exponent2, depth_leading;
  logic too_near, too_far;
  logic [47:0] key;
  logic [46:0] key_magnitude;

  // Is the first number greater than the second? Both have their leading bit at bit 62, or are 0. Among negative
  // numbers an equal one counts as farther.
  function automatic logic exceeds(input logic a_negative, input logic [62:0] a, input logic signed [17:0] a_leading, input logic b_negative,
                                   input logic [62:0] b, input logic signed [17:0] b_leading);
    logic farther;
    farther = {!a_leading[17], a_leading[16:0], a, a_negative} > {!b_leading[17], b_leading[16:0], b, 1'b0};
    if (!a[62] || !b[62] || a_negative != b_negative) exceeds = (a[62] && !a_negative && (!b[62] || b_negative)) || (!a[62] && b[62] && b_negative);
    else exceeds = farther != a_negative;
  endfunction

  always_comb begin
    if (depth_leading < -18'sd256) key_magnitude = 47'd0;
    else if (depth_leading >= 18'sd256) key_magnitude = {47{1'b1}};
    else key_magnitude = {9'(depth_leading + 18'sd256), depth_normal[61:24]};
  end
  always_ff @(posedge clk) begin
    depth_magnitude <= 63'(depth0[63] ? -depth0 : depth0);
    if (phase == 2) begin
      {depth_coarse, bytes} <= {depth_magnitude, 3'd0};
      {depth_negative1, depth_exponent1} <= {depth0[63], depth_exponent0};
      {depth_fine, ones, kept_bytes} <= {depth_coarse, 3'd0, bytes};
      {depth_negative2, depth_exponent2} <= {depth_negative1, depth_exponent1};
      {depth_negative, depth_normal} <= {depth_negative2, depth_fine};
      depth_leading <= depth_exponent2 + 18'sd62 - $signed({12'd0, kept_bytes, ones});
    end else begin
      if (depth_coarse[62:55] == 0) {depth_coarse, bytes} <= {depth_coarse << 8, bytes + 3'd1};
      if (!depth_fine[62]) {depth_fine, ones} <= {depth_fine << 1, ones + 3'd1};
    end
    too_near <= !exceeds(depth_negative, depth_normal, depth_leading, near_negative, near, near_leading) ||
        (perspective && (depth_negative || !depth_normal[62]));
    too_far <= !exceeds(far_negative, far, far_leading, depth_negative, depth_normal, depth_leading);
    key <= !depth_normal[62] ? {1'b1, 47'd0} : depth_negative ? {1'b0, ~key_magnitude} : {1'b1, key_magnitude};
  end

  // Extents and opacity in fixed point: chosen in phases 0 to 2, and in phase 3 the opacity less its last bit; there
  // five cycles after that.
  logic signed [31:0] fixed_in, fixed_value;
  logic signed [17:0] fixed_exponent;
  logic signed [17:0] largest0, largest1;
  logic signed [15:0] fixed_shift;
  logic signed [17:0] fixed_distance;
  logic [4:0] fixed_far;
  logic signed [63:0] fixed_out;
  logic [62:0] extent;
  logic peak_right, peak_half;
  // Opacities from 0 to what is too large for the packet.
  localparam [splatline_pkg::PEAK+4:0] PEAK_TOP = 1 << (splatline_pkg::PEAK + 4);
  logic [splatline_pkg::PEAK+4:0] peak_fixed, peak_even;
  assign fixed_in = phase == 0 ? root_u1 : phase == 1 ? root_v1 : peak1;
  assign fixed_exponent = phase == 0 ? root_u_exponent1 : phase == 1 ? root_v_exponent1 : peak_exponent1;

  // Beyond 16 bits every shift does the same.
  function automatic logic signed [15:0] limited(input logic signed [17:0] value);
    limited = value[17:15] == {3{value[17]}} ? value[15:0] : {value[17], {15{!value[17]}}};
  endfunction

  // What is moved so far to the left that an extent reaches 2^60 is known by that, so that nothing has to saturate.
  always_ff @(posedge clk) begin
    fixed_value <= fixed_in - $signed({31'd0, phase == 3});
    fixed_distance <= -fixed_exponent - (phase == 0 || phase == 1 ? 18'sd32 : 18'(splatline_pkg::PEAK));
    fixed_far <= {fixed_far[3:0], fixed_distance <= -18'sd30};
    // An opacity in the middle between two numbers becomes another one if its last bit is taken off. Then the even one
    // is taken.
    if (phase == 3) peak_right <= fixed_distance > 0;
    if (phase == 0) peak_half <= peak_right && !fixed_out[0];
  end
  assign fixed_shift = limited(fixed_distance);
  align #(
      .BITS(32),
      .SIGNED(1),
      .SATURATES(0)
  ) align_fixed (
      .clk,
      .negative(fixed_value[31]),
      .magnitude(fixed_value),
      .shift(fixed_shift),
      .result(fixed_out)
  );

  // Extents with their slack.
  always_ff @(posedge clk) begin
    extent <= fixed_out[62:0] + {10'd0, fixed_out[62:10]};
    // The largest of three exponents, one comparison a cycle: two of them are there in phase 6, the third in phase 7.
    largest0 <= horizontal_exponent0 > cross_exponent0 ? horizontal_exponent0 : cross_exponent0;
    if (ends) largest1 <= largest0 > conic_exponent0 ? largest0 : conic_exponent0;
  end

  // A mantissa's exponent with the packet's bits, and whether it has a place there.
  function automatic logic signed [17:0] packed_exponent(input logic signed [17:0] exponent);
    packed_exponent = exponent + 18'(DROP);
  endfunction

  function automatic logic packable(input logic signed [17:0] value);
    packable = value[17:9] == {9{value[17]}};
  endfunction

  logic degenerate, shear_nothing;
  logic signed [17:0] horizontal_power, squared_width_power, shear_power, vertical_power, largest_power;
  assign horizontal_power = packed_exponent(horizontal_exponent1);
  assign squared_width_power = packed_exponent(squared_width_exponent1);
  assign shear_power = packed_exponent(shear_exponent1);
  assign vertical_power = packed_exponent(vertical_exponent1);
  assign largest_power = packed_exponent(largest1);
  always_ff @(posedge clk) begin
    degenerate <= !packable(horizontal_power) || !packable(squared_width_power) || !packable(vertical_power) ||
        !packable(largest_power);
    shear_nothing <= shear_power[17] && !packable(shear_power);
  end

  // The third round: what has been found stands still again.
  logic degenerate2, invisible2;
  logic [31:0] cutoff2;
  splatline_pkg::footprint_t known2;

  always_ff @(posedge clk) begin
    if (ends) begin
      {degenerate2, cutoff2} <= {degenerate, cutoff1[31:0]};
      peak_fixed <= peak1 <= 0 ? '0 : fixed_far[3] || fixed_out >> (splatline_pkg::PEAK + 4) != 0 ? PEAK_TOP :
          fixed_out[splatline_pkg::PEAK+4:0];
      invisible2 <= by_opacity && (peak1 <= 0 || cutoff1 <= 0);
      known2 <= 0;
      known2.centre_u <= centre[27+SUBPIXEL:0];
      known2.version <= splatline_pkg::PACKET_VERSION;
      known2.horizontal_mantissa <= horizontal1[30:DROP];
      known2.horizontal_exponent <= 10'(horizontal_power);
      known2.squared_width_mantissa <= squared_width1[30:DROP];
      known2.squared_width_exponent <= 10'(squared_width_power);
      known2.shear_mantissa <= shear_nothing ? 0 : shear1[31:DROP];
      known2.shear_exponent <= shear_nothing ? 0 : 10'(shear_power);
      known2.vertical_mantissa <= vertical1[30:DROP];
      known2.vertical_exponent <= 10'(vertical_power);
    end
  end

  // The box, its parts within the viewport, the reason. Both directions go the same way, u in phase 6 and v right
  // behind it:
  //
  //   position, extent | centre, middle | ends | ends within the viewport | nothing between them?
  logic signed [63:0] position6, centre, middle, low, high;
  logic [62:0] extent7;
  logic range7, range_extent7, outside, faint;
  logic range, range_u, range_v, outside_u, outside_v;
  logic [15:0] limit, first, last;
  assign peak_even = {peak_fixed[splatline_pkg::PEAK+4:1], peak_fixed[0] && !peak_half};

  // Is the magnitude at least 2^58?
  function automatic logic beyond(input logic signed [63:0] value);
    beyond = value[63:58] != {6{value[63]}} || (value[63] && value[57:0] == 0);
  endfunction

  function automatic logic signed [63:0] rounded(input logic signed [63:0] position);
    rounded = splatline_math::shift_round(position, 7'(32 - SUBPIXEL));
  endfunction

  // The same with half a pixel more, in one addition.
  function automatic logic signed [63:0] half_more(input logic signed [63:0] position);
    localparam signed [63:0] HALF = 1 << (SUBPIXEL - 1);
    half_more = 64'($signed({position >>> (32 - SUBPIXEL), 1'b1} + {HALF, position[31-SUBPIXEL]}) >>> 1);
  endfunction

  function automatic logic [15:0] clipped(input logic signed [31:0] value, input logic [15:0] edge_of);
    clipped = value < 0 ? 16'd0 : value > $signed({16'd0, edge_of}) ? edge_of : value[15:0];
  endfunction

  function automatic logic [splatline_pkg::COLOUR_BITS-1:0] shaded(input logic [31:0] value);
    shaded = splatline_pkg::COLOUR_BITS'(splatline_math::shaded(value, 5'(28 - COLOUR), 6'(splatline_pkg::COLOUR_BITS)));
  endfunction

  assign packet_taken = packet_valid;
  always_ff @(posedge clk) begin
    position6 <= phase == 5 ? u1 : v1;
    centre <= rounded(position6);
    // A half more: of the pixels' middles and of both ends' roundings. -x - 1 is ~x.
    middle <= half_more(position6);
    extent7 <= extent;
    range7 <= beyond(position6);
    range_extent7 <= fixed_far[4] || extent[62:60] != 0;
    low <= (middle <<< (32 - SUBPIXEL)) + $signed({1'b1, ~extent7});
    high <= (middle <<< (32 - SUBPIXEL)) + $signed({1'b0, extent7});
    limit <= phase == 7 ? columns : rows;
    first <= clipped(low[63:32], limit);
    last <= clipped(high[63:32], limit);
    outside <= first >= last;
    faint <= peak_even == 0;

    if (ends) {range, range_u} <= {range7, range_extent7};
    if (phase == 0) begin
      packet <= known2;
      {range, range_v, packet.centre_v} <= {range || range7, range_extent7, centre[27+SUBPIXEL:0]};
    end
    if (phase == 1) {packet.first_column, packet.end_column} <= {first, last};
    if (phase == 2) {outside_u, packet.first_row, packet.end_row} <= {outside, first, last};
    if (phase == 3) outside_v <= outside;

    packet_valid <= phase == 5 && valid2 && !rst;
    cull <= too_near ? 3'd1 : too_far ? 3'd2 : range ? 3'd3 : degenerate2 ? 3'd4 : invisible2 ? 3'd5 : range_u ? 3'd3 :
        outside_u ? 3'd6 : range_v ? 3'd3 : outside_v ? 3'd6 : faint ? 3'd5 : 3'd0;
    depth <= key;
    packet.cutoff <= cutoff2;
    packet.peak <= peak_even[splatline_pkg::PEAK+4] ? {(splatline_pkg::PEAK + 4) {1'b1}} : peak_even[splatline_pkg::PEAK+3:0];
    packet.red <= shaded(colour[31:0]);
    packet.green <= shaded(colour[63:32]);
    packet.blue <= shaded(colour[95:64]);
  end
endmodule
