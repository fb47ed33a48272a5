// Opacity and deep-alpha "over", nearest splat first, of one lane (`opacity` and `front_to_back` of src/blend/mod.rs).
//
//   4-6 product of peak and weight | 7 skip, rounding | 8 opacity | 9-10 share of the transmittance | 11 its new value |
//   12-13 what the splat adds to each colour | 14 the sums
//
// A name's number is the stage: 0 is the lane's pixel, and its weight arrives in stage 4. A pixel's transmittance is read in stage 6 and
// written in stage 11, its colour in 11 and 14. So a pixel may come again INTERVAL = 6 cycles later and not before,
// which the lane sees to (lane.sv).
module blend #(
    parameter ADDRESS = 10
) (
    input logic clk,
    input logic rst,
    input logic advance,
    input splatline_pkg::rules_t rules,
    input logic pixel_valid,
    input logic [ADDRESS-1:0] pixel_address,
    input logic [splatline_pkg::WEIGHT:0] weight,
    input logic [splatline_pkg::PEAK+3:0] peak,
    input logic [3*(splatline_pkg::COLOUR+4)-1:0] colour,  // blue, green, red
    // Transmittance: flag and UQ1.transmittance; the word of `read_address` arrives a cycle later.
    output logic [ADDRESS-1:0] depth_read_address,
    input logic [splatline_pkg::TRANSMITTANCE+1:0] depth_read,
    output logic depth_write,
    output logic [ADDRESS-1:0] depth_write_address,
    output logic [splatline_pkg::TRANSMITTANCE+1:0] depth_word,
    // Colours: blue, green, red, UQ5.accumulator each.
    output logic [ADDRESS-1:0] colour_read_address,
    input logic [3*splatline_pkg::SUM_BITS-1:0] colour_read,
    output logic colour_write,
    output logic [ADDRESS-1:0] colour_write_address,
    output logic [3*splatline_pkg::SUM_BITS-1:0] colour_word,
    output logic idle
);
  localparam ALPHA = splatline_pkg::ALPHA;
  localparam T = splatline_pkg::TRANSMITTANCE;
  localparam C = splatline_pkg::COLOUR + 4;
  localparam SUM = splatline_pkg::SUM_BITS;
  localparam PEAK = splatline_pkg::PEAK + 4;
  localparam WEIGHT = splatline_pkg::WEIGHT;
  localparam OPACITY_SHIFT = splatline_pkg::PEAK + WEIGHT - ALPHA;
  localparam COLOUR_SHIFT = T + splatline_pkg::COLOUR - splatline_pkg::ACCUMULATOR;

  logic valid5, valid6, valid7, valid8, valid9, valid10, valid11, valid12, valid13, valid14;
  logic [ADDRESS-1:0] address6, address11, address14;
  logic [3*C-1:0] colour11;
  delay #(.BITS(ADDRESS), .STAGES(2)) hold_address6 (.clk, .rst, .advance, .in(pixel_address), .out(address6));
  delay #(.BITS(ADDRESS), .STAGES(5)) hold_address11 (.clk, .rst, .advance, .in(address6), .out(address11));
  delay #(.BITS(ADDRESS), .STAGES(3)) hold_address14 (.clk, .rst, .advance, .in(address11), .out(address14));
  delay #(.BITS(3 * C), .STAGES(7)) hold_colour (.clk, .rst, .advance, .in(colour), .out(colour11));

  // Stages 4 to 8: opacity, clamped; what the rules skip by its product goes no further.
  localparam [PEAK+WEIGHT:0] OPACITY_HALF = 1 << (OPACITY_SHIFT - 1);
  logic [PEAK+WEIGHT:0] product6;
  logic [PEAK+WEIGHT-OPACITY_SHIFT:0] rounded7;
  logic skipped7;
  logic [ALPHA:0] alpha8;
  multiply #(
      .LEFT (PEAK),
      .RIGHT(WEIGHT + 1)
  ) opacity (
      .clk,
      .advance,
      .left(peak),
      .right(weight),
      .product(product6)
  );
  always_ff @(posedge clk)
    if (advance) begin
      rounded7 <= (PEAK + WEIGHT - OPACITY_SHIFT + 1)'((product6 + OPACITY_HALF) >> OPACITY_SHIFT);
      skipped7 <= product6 < (PEAK + WEIGHT + 1)'(rules.least);
      alpha8 <= rounded7 > (PEAK + WEIGHT - OPACITY_SHIFT + 1)'(rules.alpha_max) ? rules.alpha_max : rounded7[ALPHA:0];
    end

  // Stages 6 to 8: the transmittance. Stages 8 to 10: the share of it that the splat takes.
  localparam [T+ALPHA+1:0] SHARE_HALF = 1 << (ALPHA - 1);
  logic [T+1:0] depth8, depth10;
  logic [T+ALPHA+1:0] product10;
  logic [T:0] share10, rest10;
  logic signed [T+1:0] beyond9, beyond10;
  logic [T+1:0] depth9;
  logic stop10;
  assign depth_read_address = address6;
  multiply #(
      .LEFT (T + 1),
      .RIGHT(ALPHA + 1),
      .ADD  (SHARE_HALF)
  ) share (
      .clk,
      .advance,
      .left(depth8[T:0]),
      .right(alpha8),
      .product(product10)
  );
  // An opacity of at most 1 takes at most all.
  assign share10 = product10[T+ALPHA:ALPHA];
  // Stage 10: what is left, and beside it, not behind it, whether that is too little: rest <= stop.
  assign rest10 = depth10[T:0] - share10;
  assign stop10 = beyond10 <= $signed({1'b0, share10});
  always_ff @(posedge clk)
    if (advance) begin
      depth8 <= depth_read;
      depth9 <= depth8;
      depth10 <= depth9;
      beyond9 <= $signed({1'b0, depth8[T:0]}) - $signed({1'b0, rules.stop});
      beyond10 <= beyond9;
    end

  // Stage 11: its new value.
  logic [T:0] share11;
  assign depth_write = advance && valid11;
  assign depth_write_address = address11;
  always_ff @(posedge clk)
    if (advance) begin
      depth_word <= stop10 && rules.stop_before ? {1'b1, depth10[T:0]} : {stop10, rest10};
      share11 <= share10;
    end

  // Stages 11 to 14: the sums. A share of 1 in all and colours below 16, rounded up to double at most, stay below 32.
  logic coloured11;
  logic [3*SUM-1:0] colour13;
  assign colour_read_address = address11;
  assign colour_write = advance && valid14;
  assign colour_write_address = address14;
  genvar channel;
  generate
    for (channel = 0; channel < 3; channel = channel + 1) begin : gen_channel
      localparam [T+C:0] COLOUR_HALF = 1 << (COLOUR_SHIFT - 1);
      logic [T+C:0] product13;
      multiply #(
          .LEFT (T + 1),
          .RIGHT(C),
          .ADD  (COLOUR_HALF)
      ) layer (
          .clk,
          .advance,
          .left(share11),
          .right(colour11[channel*C+:C]),
          .product(product13)
      );
      always_ff @(posedge clk)
        if (advance) colour_word[channel*SUM+:SUM] <= colour13[channel*SUM+:SUM] + product13[COLOUR_SHIFT+:SUM];
    end
  endgenerate

  always_ff @(posedge clk) begin
    if (rst) begin
      valid5 <= 0;
      valid6 <= 0;
      valid7 <= 0;
      valid8 <= 0;
      valid9 <= 0;
      valid10 <= 0;
      valid11 <= 0;
      coloured11 <= 0;
      valid12 <= 0;
      valid13 <= 0;
      valid14 <= 0;
    end else if (advance) begin
      valid5 <= pixel_valid;
      valid6 <= valid5;
      valid7 <= valid6;
      valid8 <= valid7 && !skipped7;
      valid9 <= valid8;
      valid10 <= valid9;
      valid11 <= valid10 && !depth10[T+1];
      coloured11 <= valid10 && !depth10[T+1] && !(stop10 && rules.stop_before);
      valid12 <= coloured11;
      valid13 <= valid12;
      valid14 <= valid13;
    end
    if (advance) colour13 <= colour_read;
  end

  assign idle = !(valid5 || valid6 || valid7 || valid8 || valid9 || valid10 || valid11 || valid12 || valid13 || valid14);
endmodule
