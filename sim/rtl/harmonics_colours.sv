// Colours of splats with harmonics: from directions, which setup gives long before it gives their packets, and from
// coefficients in memory.
//
//   direction -> fifo -------------------------> harmonics_unit -> colour, rounded
//            `-> fifo -> addresses -> memory -> fifo -^
//
// A splat has a word for its base and one for each coefficient, one splat after the other in the scene's order. Those
// of culled splats are not read. Whoever gives directions holds as many packets as there are places for them, so that
// there is always one.
module harmonics_colours #(
    parameter MULTIPLIERS = 1,
    parameter PLACES = 32,
    parameter WORDS = 128  // that are read ahead
) (
    input logic clk,
    input logic rst,
    input logic begins,
    input logic [31:0] base,
    input logic [2:0] degree,
    input logic direction_valid,
    input logic direction_seen,
    input logic [95:0] direction,
    output logic read_valid,
    input logic read_ready,
    output logic [31:0] read_address,
    input logic word_valid,
    input logic [95:0] word,
    output logic colour_valid,
    input logic colour_ready,
    output logic [3*splatline_pkg::COLOUR_BITS-1:0] colour  // red in the lowest bits
);
  // Of splats that are seen, what is read and in which direction.
  logic [4:0] count;
  logic [31:0] next, address;
  logic seen, address_valid, requested;
  always_comb begin
    case (degree)
      3'd0: count = 5'd1;
      3'd1: count = 5'd4;
      3'd2: count = 5'd9;
      3'd3: count = 5'd16;
      default: count = 5'd25;
    endcase
  end
  assign seen = direction_valid && direction_seen;
  always_ff @(posedge clk) begin
    if (direction_valid) next <= next + 32'(count);
    if (begins) next <= base;
  end
  fifo #(
      .BITS(32),
      .PLACES(PLACES)
  ) addresses (
      .clk,
      .rst,
      .claim(seen),
      .free(),
      .none(),
      .in_valid(seen),
      .in(next),
      .out_valid(address_valid),
      .out_ready(requested),
      .out(address),
      .next()
  );

  logic splat_valid, splat_ready, coefficient_valid, coefficient_ready;
  logic [95:0] splat, coefficient, exact;
  fifo #(
      .BITS(96),
      .PLACES(PLACES)
  ) directions (
      .clk,
      .rst,
      .claim(seen),
      .free(),
      .none(),
      .in_valid(seen),
      .in(direction),
      .out_valid(splat_valid),
      .out_ready(splat_ready),
      .out(splat),
      .next()
  );
  memory_stream #(
      .BITS(96),
      .PLACES(WORDS)
  ) words (
      .clk,
      .rst,
      .begins(address_valid && requested),
      .first(address),
      .count(32'(count)),
      .none(count == 0),
      .read_valid,
      .read_ready,
      .read_address,
      .requested,
      .word_valid,
      .word,
      .out_valid(coefficient_valid),
      .out_ready(coefficient_ready),
      .out(coefficient)
  );

  harmonics_unit #(
      .MULTIPLIERS(MULTIPLIERS)
  ) unit (
      .clk,
      .rst,
      .splat_valid,
      .splat_ready,
      .direction(splat),
      .degree,
      .word_valid(coefficient_valid),
      .word_ready(coefficient_ready),
      .word(coefficient),
      .colour_valid,
      .colour_ready,
      .colour(exact)
  );
  genvar channel;
  generate
    for (channel = 0; channel < 3; channel = channel + 1) begin : gen_channel
      assign colour[channel*splatline_pkg::COLOUR_BITS+:splatline_pkg::COLOUR_BITS] = splatline_pkg::COLOUR_BITS'(
          splatline_math::shaded(exact[32*channel+:32], 5'(28 - splatline_pkg::COLOUR), 6'(splatline_pkg::COLOUR_BITS)));
    end
  endgenerate
endmodule
