// The last step of setup: a core's results become a packet, or the reason why there is none.
//
// Its words come in eight cycles, from phase 0 on; two rounds of eight phases later the packet leaves. What needs 64 bits once for a splat stands
// here and not in the cores: the comparison with the planes of depth (`Extended::exceeds`), the sort key (`depth::key`), the box
// (`bounding_box`), the fixed-point opacity. Of the conic only its exponent counts, since splats without a place for it are culled. The order of the reasons is the kernel's.
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
    input logic [splatline_setup_pkg::WORD_BITS-1:0] word,
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
  logic [31:0] depth0, u0, v0, high_u0;
  logic signed [17:0] depth_exponent0;
  logic signed [31:0] peak0, root_u0, root_v0, horizontal0, squared_width0, shear0, vertical0;
  logic signed [17:0] peak_exponent0, root_u_exponent0, root_v_exponent0, horizontal_exponent0, squared_width_exponent0, shear_exponent0, vertical_exponent0,
      cross_exponent0, conic_exponent0;
  logic signed [32:0] cutoff0;
  logic valid0, valid1, valid2;
  assign {word_a, word_a_exponent, word_b, word_b_exponent} = word;
  always_ff @(posedge clk) begin
    case (phase)
      3'd0: {depth0, depth_exponent0, peak0, peak_exponent0} <= {word_a[31:0], word_a_exponent, word_b[31:0], word_b_exponent};
      3'd1: {u0, cutoff0} <= {word_a[31:0], word_b};
      3'd2: {v0, root_u0, root_u_exponent0} <= {word_a[31:0], word_b[31:0], word_b_exponent};
      3'd3: {root_v0, root_v_exponent0, horizontal0, horizontal_exponent0} <= {word_a[31:0], word_a_exponent, word_b[31:0], word_b_exponent};
      3'd4: {squared_width0, squared_width_exponent0, shear0, shear_exponent0} <= {word_a[31:0], word_a_exponent, word_b[31:0], word_b_exponent};
      3'd5: {vertical0, vertical_exponent0, cross_exponent0} <= {word_a[31:0], word_a_exponent, word_b_exponent};
      3'd6: {conic_exponent0, high_u0} <= {word_a_exponent, word_b[31:0]};
      default: ;
    endcase
    if (rst) {valid0, valid1, valid2} <= 0;
    else begin
      if (phase == 0) valid0 <= valid;
      if (phase == 7) {valid1, valid2} <= {valid0, valid1};
    end
  end

  // The second round of phases: all of a splat's words stand still, and what is computed from them runs through registers.
  logic signed [63:0] depth1, u1, v1;
  logic signed [17:0] depth_exponent1;
  logic signed [31:0] peak1, root_u1, root_v1, horizontal1, squared_width1, shear1, vertical1;
  logic signed [17:0] peak_exponent1, root_u_exponent1, root_v_exponent1, horizontal_exponent1, squared_width_exponent1, shear_exponent1, vertical_exponent1;
  logic signed [32:0] cutoff1;
  always_ff @(posedge clk) begin
    if (phase == 7) begin
      {depth1, depth_exponent1, cutoff1} <= {word_a[31:0], depth0, depth_exponent0, cutoff0};
      {u1, v1} <= {high_u0, u0, word_b[31:0], v0};
      {peak1, root_u1, root_v1, horizontal1, squared_width1, shear1} <= {peak0, root_u0, root_v0, horizontal0, squared_width0, shear0};
      vertical1 <= vertical0;
      {peak_exponent1, root_u_exponent1, root_v_exponent1} <= {peak_exponent0, root_u_exponent0, root_v_exponent0};
      {horizontal_exponent1, squared_width_exponent1, shear_exponent1} <= {horizontal_exponent0, squared_width_exponent0, shear_exponent0};
      vertical_exponent1 <= vertical_exponent0;
    end
  end

  // Depth: leading bit at bit 62, comparisons, key.
  logic [63:0] depth_magnitude;
  logic [62:0] depth_normal;
  logic [6:0] depth_length;
  logic signed [17:0] depth_leading;
  logic depth_nothing, too_near, too_far;
  logic [47:0] key;
  logic [46:0] key_magnitude;

  // Is the first number greater than the second? Both have their leading bit at bit 62, or are 0. Among negative numbers an equal one counts as farther.
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
    depth_magnitude <= depth1[63] ? -depth1 : depth1;
    depth_length <= splatline_math::length(depth_magnitude);
    depth_normal <= 63'(depth_magnitude << (6'd63 - depth_length[5:0]));
    depth_leading <= depth_exponent1 + $signed({11'd0, depth_length}) - 18'sd1;
    depth_nothing <= depth_length == 0;
    too_near <= !exceeds(depth1[63], depth_normal, depth_leading, near_negative, near, near_leading) || (perspective && (depth1[63] || depth_nothing));
    too_far <= !exceeds(far_negative, far, far_leading, depth1[63], depth_normal, depth_leading);
    key <= depth_nothing ? {1'b1, 47'd0} : depth1[63] ? {1'b0, ~key_magnitude} : {1'b1, key_magnitude};
  end

  // Opacity and extents in fixed point: chosen in phases 0 to 2, with their signs and distances; there four cycles after that.
  logic signed [31:0] fixed_in;
  logic [31:0] fixed_value;
  logic signed [17:0] fixed_exponent;
  logic signed [17:0] largest0, largest1;
  logic signed [15:0] fixed_shift;
  logic signed [17:0] fixed_distance;
  logic signed [63:0] fixed_out, extent;
  // Opacities from 0 to what is too large for the packet.
  localparam [splatline_pkg::PEAK+4:0] PEAK_TOP = 1 << (splatline_pkg::PEAK + 4);
  logic [splatline_pkg::PEAK+4:0] peak_fixed, peak_fixed2, peak_even;
  assign fixed_in = phase == 0 ? peak1 : phase == 1 ? root_u1 : root_v1;
  assign fixed_exponent = phase == 0 ? peak_exponent1 : phase == 1 ? root_u_exponent1 : root_v_exponent1;

  // Beyond 16 bits every shift does the same.
  function automatic logic signed [15:0] limited(input logic signed [17:0] value);
    limited = value > 18'sd16000 ? 16'sd16000 : value < -18'sd16000 ? -16'sd16000 : value[15:0];
  endfunction

  always_ff @(posedge clk) begin
    fixed_value <= fixed_in;
    fixed_distance <= -fixed_exponent - (phase == 0 ? 18'(splatline_pkg::PEAK) : 18'sd32);
  end
  assign fixed_shift = limited(fixed_distance);
  align #(
      .BITS(32),
      .SIGNED(1)
  ) align_fixed (
      .clk,
      .negative(fixed_value[31]),
      .magnitude(fixed_value),
      .shift(fixed_shift),
      .result(fixed_out)
  );

  // Extents with their slack.
  function automatic logic [63:0] widened(input logic signed [63:0] plain);
    logic [64:0] sum;
    sum = {1'b0, plain} + {11'd0, plain[63:10]};
    widened = sum[64] || sum[63] ? {1'b0, {63{1'b1}}} : sum[63:0];
  endfunction
  always_ff @(posedge clk) extent <= widened(fixed_out);

  // Does the opacity lie in the middle between two numbers? Then the even one is taken. Distance, what is dropped and the answer have a cycle each.
  logic signed [17:0] peak_dropped;
  logic peak_half, peak_within;
  logic [31:0] peak_rest;
  always_ff @(posedge clk) begin
    // The largest of three exponents, one comparison a cycle: two of them are there in phase 6, the third in phase 7.
    largest0 <= horizontal_exponent0 > cross_exponent0 ? horizontal_exponent0 : cross_exponent0;
    if (phase == 7) largest1 <= largest0 > conic_exponent0 ? largest0 : conic_exponent0;
    peak_dropped <= -peak_exponent1 - 18'(splatline_pkg::PEAK);
    peak_rest <= peak1 << (5'd0 - peak_dropped[4:0]);
    peak_within <= peak_dropped >= 18'sd1 && peak_dropped <= 18'sd31;
    peak_half <= peak_within && peak_rest == 32'h80000000;
    if (phase == 5) peak_fixed <= fixed_out[63] ? '0 : fixed_out >> (splatline_pkg::PEAK + 4) != 0 ? PEAK_TOP : fixed_out[splatline_pkg::PEAK+4:0];
  end

  // A mantissa's exponent with the packet's bits, and whether it has a place there.
  function automatic logic signed [17:0] packed_exponent(input logic signed [17:0] exponent);
    packed_exponent = exponent + 18'(DROP);
  endfunction

  function automatic logic packable(input logic signed [17:0] exponent);
    packable = exponent >= 18'(-512 - DROP) && exponent <= 18'(511 - DROP);
  endfunction

  logic degenerate, shear_nothing;
  always_ff @(posedge clk) begin
    degenerate <= !packable(horizontal_exponent1) || !packable(squared_width_exponent1) || !packable(vertical_exponent1) || !packable(largest1);
    shear_nothing <= shear_exponent1 < 18'(-512 - DROP);
  end

  // The third round: what has been found stands still again; the second extent comes a cycle after the rest.
  logic signed [63:0] u2, v2, extent_u2, extent_v2;
  logic near2, far2, degenerate2, peak_half2, invisible2;
  logic [31:0] cutoff2;
  splatline_pkg::footprint_t known2;
  logic [47:0] key2;

  always_ff @(posedge clk) begin
    if (phase == 0) extent_v2 <= extent;
    if (phase == 7) begin
      {u2, v2, near2, far2, degenerate2, peak_half2, cutoff2} <= {u1, v1, too_near, too_far, degenerate, peak_half, cutoff1[31:0]};
      extent_u2 <= extent;
      peak_fixed2 <= peak_fixed;
      invisible2 <= by_opacity && (peak1 <= 0 || cutoff1 <= 0);
      known2 <= 0;
      known2.version <= splatline_pkg::PACKET_VERSION;
      key2 <= key;
      known2.horizontal_mantissa <= horizontal1[30:DROP];
      known2.horizontal_exponent <= 10'(packed_exponent(horizontal_exponent1));
      known2.squared_width_mantissa <= squared_width1[30:DROP];
      known2.squared_width_exponent <= 10'(packed_exponent(squared_width_exponent1));
      known2.shear_mantissa <= shear_nothing ? 0 : shear1[31:DROP];
      known2.shear_exponent <= shear_nothing ? 0 : 10'(packed_exponent(shear_exponent1));
      known2.vertical_mantissa <= vertical1[30:DROP];
      known2.vertical_exponent <= 10'(packed_exponent(vertical_exponent1));
    end
  end

  // The box, its parts within the viewport, the reason.
  logic signed [63:0] centre_u, centre_v, middle_u, middle_v, low_u, low_v, high_u, high_v;
  logic range, range_u, range_v, outside_u, outside_v, faint;
  logic [15:0] first_u, first_v, last_u, last_v;
  assign peak_even = {peak_fixed2[splatline_pkg::PEAK+4:1], peak_fixed2[0] && !peak_half2};

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

  function automatic logic [15:0] clipped(input logic signed [31:0] value, input logic [15:0] limit);
    clipped = value < 0 ? 16'd0 : value > $signed({16'd0, limit}) ? limit : value[15:0];
  endfunction

  // Halves go to the even neighbour; what is beyond the range becomes its largest number.
  localparam RANGE = splatline_pkg::COLOUR_BITS - COLOUR;
  function automatic logic [COLOUR+RANGE-1:0] shaded(input logic [31:0] value);
    logic [COLOUR+4:0] nearest;
    nearest = {1'b0, value[31-:COLOUR+4]};
    if (value[27-COLOUR] && (value[26-COLOUR:0] != 0 || nearest[0])) nearest = nearest + 1'b1;
    shaded = nearest >> (COLOUR + RANGE) != 0 ? '1 : nearest[COLOUR+RANGE-1:0];
  endfunction

  assign packet_taken = packet_valid;
  always_ff @(posedge clk) begin
    {centre_u, centre_v} <= {rounded(u2), rounded(v2)};
    // A half more: of the pixels' middles and of both ends' roundings. -x - 1 is ~x.
    {middle_u, middle_v} <= {half_more(u2), half_more(v2)};
    low_u <= (middle_u <<< (32 - SUBPIXEL)) + ~extent_u2;
    low_v <= (middle_v <<< (32 - SUBPIXEL)) + ~extent_v2;
    high_u <= (middle_u <<< (32 - SUBPIXEL)) + extent_u2;
    high_v <= (middle_v <<< (32 - SUBPIXEL)) + extent_v2;
    {first_u, first_v} <= {clipped(low_u[63:32], columns), clipped(low_v[63:32], rows)};
    {last_u, last_v} <= {clipped(high_u[63:32], columns), clipped(high_v[63:32], rows)};
    range <= beyond(u2) || beyond(v2);
    range_u <= extent_u2[62:60] != 0;
    range_v <= extent_v2[62:60] != 0;
    outside_u <= first_u >= last_u;
    outside_v <= first_v >= last_v;
    faint <= peak_even == 0;

    packet_valid <= phase == 5 && valid2 && !rst;
    cull <= near2 ? 3'd1 : far2 ? 3'd2 : range ? 3'd3 : degenerate2 ? 3'd4 : invisible2 ? 3'd5 : range_u ? 3'd3 : outside_u ? 3'd6 :
        range_v ? 3'd3 : outside_v ? 3'd6 : faint ? 3'd5 : 3'd0;
    depth <= key2;
    packet <= known2;
    packet.centre_u <= centre_u[27+SUBPIXEL:0];
    packet.centre_v <= centre_v[27+SUBPIXEL:0];
    packet.first_column <= first_u;
    packet.first_row <= first_v;
    packet.end_column <= last_u;
    packet.end_row <= last_v;
    packet.cutoff <= cutoff2;
    packet.peak <= peak_even[splatline_pkg::PEAK+4] ? {(splatline_pkg::PEAK + 4) {1'b1}} : peak_even[splatline_pkg::PEAK+3:0];
    packet.red <= shaded(colour[31:0]);
    packet.green <= shaded(colour[63:32]);
    packet.blue <= shaded(colour[95:64]);
  end
endmodule
