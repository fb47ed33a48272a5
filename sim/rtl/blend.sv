// Opacity and deep-alpha "over", nearest splat first, of one lane (`opacity` and `front_to_back` of src/blend/mod.rs).
//
// Stages: opacity | transmittance | colour products | colour sums. Transmittance and colour are read, changed and written within one
// stage each, and the word written last is kept beside the memory: a pixel that follows itself in the next cycle
// finds its new value there, so that no hazard ever stalls a lane.
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
    input splatline_pkg::paint_t paint,
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
  localparam C = splatline_pkg::COLOUR;
  localparam SUM = splatline_pkg::SUM_BITS;
  localparam OPACITY_SHIFT = splatline_pkg::PEAK + splatline_pkg::WEIGHT - ALPHA;
  localparam COLOUR_SHIFT = T + C - splatline_pkg::ACCUMULATOR;

  // Stage 1: opacity, rounded, clamped; what the rules skip goes no further.
  localparam PEAK = splatline_pkg::PEAK + 4;
  localparam WEIGHT = splatline_pkg::WEIGHT;
  localparam [PEAK+WEIGHT-1:0] OPACITY_HALF = 1 << (OPACITY_SHIFT - 1);
  logic [PEAK+WEIGHT-1:0] product0, opacity0;
  logic [ALPHA:0] alpha0;
  offset_multiply #(
      .VALUE(PEAK),
      .BITS(WEIGHT)
  ) opacity (
      .value(paint.peak),
      .factor(weight),
      .product(product0)
  );
  assign opacity0 = (product0 + OPACITY_HALF) >> OPACITY_SHIFT;
  assign alpha0 = opacity0 > (PEAK + WEIGHT)'(rules.alpha_max) ? rules.alpha_max : opacity0[ALPHA:0];
  logic valid1;
  logic [ADDRESS-1:0] address1;
  logic [ALPHA:0] alpha1;
  logic [3*C+11:0] colour1;

  // Stage 2: the share of the transmittance that the splat takes.
  logic valid2;
  logic [ADDRESS-1:0] address2;
  logic [ALPHA:0] alpha2;
  logic [3*C+11:0] colour2;
  logic kept_depth_valid;
  logic [ADDRESS-1:0] kept_depth_address;
  logic [T+1:0] kept_depth, depth2;
  localparam [T+ALPHA:0] SHARE_HALF = 1 << (ALPHA - 1);
  logic [T+ALPHA:0] product2, share2;
  logic [T:0] rest2;
  logic stop2;
  assign depth2 = kept_depth_valid && kept_depth_address == address2 ? kept_depth : depth_read;
  offset_multiply #(
      .VALUE(T + 1),
      .BITS(ALPHA)
  ) share (
      .value(depth2[T:0]),
      .factor(alpha2),
      .product(product2)
  );
  // An opacity of at most 1 takes at most all.
  assign share2 = (product2 + SHARE_HALF) >> ALPHA;
  assign rest2 = depth2[T:0] - share2[T:0];
  assign stop2 = rest2 <= rules.stop;
  assign depth_read_address = address1;
  assign depth_write = advance && valid2 && !depth2[T+1];
  assign depth_write_address = address2;
  assign depth_word = stop2 && rules.stop_before ? {1'b1, depth2[T:0]} : {stop2, rest2};

  // Stage 3: what the splat adds to each colour.
  logic valid3;
  logic [ADDRESS-1:0] address3;
  logic [T:0] share3;
  logic [3*C+11:0] colour3;
  assign colour_read_address = address3;

  // Stage 4: the sums. A share of 1 in all and colours below 16, rounded up to double at most, stay below 32.
  logic valid4;
  logic [ADDRESS-1:0] address4;
  logic [3*SUM-1:0] added4, colour4;
  logic kept_colour_valid;
  logic [ADDRESS-1:0] kept_colour_address;
  logic [3*SUM-1:0] kept_colour;
  assign colour4 = kept_colour_valid && kept_colour_address == address4 ? kept_colour : colour_read;
  assign colour_write = advance && valid4;
  assign colour_write_address = address4;

  genvar channel;
  generate
    for (channel = 0; channel < 3; channel = channel + 1) begin : gen_channel
      localparam [T+C+4:0] COLOUR_HALF = 1 << (COLOUR_SHIFT - 1);
      logic [T+C+4:0] product, added;
      offset_multiply #(
          .VALUE(T + 1),
          .BITS(C + 4)
      ) layer (
          .value(share3),
          .factor({1'b0, colour3[channel*(C+4)+:C+4]}),
          .product
      );
      assign added = (product + COLOUR_HALF) >> COLOUR_SHIFT;
      always_ff @(posedge clk) if (advance) added4[channel*SUM+:SUM] <= added[SUM-1:0];
      assign colour_word[channel*SUM+:SUM] = colour4[channel*SUM+:SUM] + added4[channel*SUM+:SUM];
    end
  endgenerate

  always_ff @(posedge clk) begin
    if (rst) begin
      valid1 <= 0;
      valid2 <= 0;
      valid3 <= 0;
      valid4 <= 0;
      kept_depth_valid <= 0;
      kept_colour_valid <= 0;
    end else if (advance) begin
      valid1 <= pixel_valid && alpha0 >= rules.alpha_min && alpha0 != 0;
      valid2 <= valid1;
      valid3 <= depth_write && !(stop2 && rules.stop_before);
      valid4 <= valid3;
      kept_depth_valid <= depth_write;
      kept_colour_valid <= colour_write;
    end
    if (advance) begin
      address1 <= pixel_address;
      alpha1 <= alpha0;
      colour1 <= {paint.blue, paint.green, paint.red};
      address2 <= address1;
      alpha2 <= alpha1;
      colour2 <= colour1;
      address3 <= address2;
      share3 <= share2[T:0];
      colour3 <= colour2;
      address4 <= address3;
      kept_depth_address <= address2;
      kept_depth <= depth_word;
      kept_colour_address <= address4;
      kept_colour <= colour_word;
    end
  end

  assign idle = !(valid1 || valid2 || valid3 || valid4);
endmodule
