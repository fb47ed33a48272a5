// Opacity and deep-alpha "over", nearest splat first, of one lane (`opacity` and `front_to_back` of src/blend/mod.rs).
//
//   4-6 product of peak and weight | 7 skip, rounding | 8 opacity | 9-10 share of the transmittance |
//   11 its new value | 12-13 what the splat adds to each colour | 14 the sums
//
// A name's number is the stage; the weight arrives in stage 4. A pixel's transmittance is read from stage 5 on and
// written in stage 11, its colour from 10 on and in 14. So a pixel may come again INTERVAL = 7 cycles later and not
// before, which the lane sees to (lane.sv). The words that are written have their registers in the buffer's banks
// (tile_buffer.sv), of which there are two.
//
// Where a product is rounded and then added to something, its half rides on that addition: the bit below the result is
// a carry. With ties to even a product in the middle carries only from an odd number on; of a colour, where the sum is
// what is rounded, an odd sum loses its last bit again. Most of the bits below a half are there a stage before the
// product, and are asked then.
module blend #(
    parameter ADDRESS = 10,
    parameter SLOT_BITS = 4,
    parameter ADDED_BITS = 4,  // of multiply.sv, for opacity and share
    parameter WIDE_MULTIPLIERS = 4  // of a colour's product, if it is wide: 4, or 3 (multiply_three.sv)
) (
    input logic clk,
    input logic rst,
    input logic advance,
    input splatline_pkg::rules_t rules,
    input logic pixel_valid,
    input logic [ADDRESS-1:0] pixel_address,
    input logic [splatline_pkg::WEIGHT:0] weight,
    input logic [splatline_pkg::PEAK+3:0] peak,
    input logic [SLOT_BITS-1:0] pixel_slot,
    // The colour of the run with this number, which arrives in the next cycle: blue, green, red.
    output logic [SLOT_BITS-1:0] colour_slot,
    input logic [3*splatline_pkg::COLOUR_BITS-1:0] colour11,
    input logic [53:0] colour_sums11,
    // Transmittance: flag and UQ1.transmittance; the word of `read_address` arrives two cycles later.
    output logic [ADDRESS-1:0] transmittance_read_address,
    input logic [splatline_pkg::TRANSMITTANCE+1:0] transmittance_read,
    // What is written in the next cycle.
    output logic transmittance_write,
    output logic [ADDRESS-1:0] transmittance_write_address,
    output logic [splatline_pkg::TRANSMITTANCE+1:0] transmittance_word,
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
  localparam C = splatline_pkg::COLOUR_BITS;
  localparam SUM = splatline_pkg::SUM_BITS;
  localparam PEAK = splatline_pkg::PEAK + 4;
  localparam WEIGHT = splatline_pkg::WEIGHT;
  localparam OPACITY_SHIFT = splatline_pkg::PEAK + WEIGHT - ALPHA;
  localparam EVEN = splatline_pkg::TIES_TO_EVEN;
  localparam COLOUR_SHIFT = T + splatline_pkg::COLOUR - splatline_pkg::ACCUMULATOR;
  // A share's 1.0 stands apart where few bits are left over by a multiplier without it.
  localparam APART = T % 18 <= 4;
  localparam THREE = WIDE_MULTIPLIERS == 3 && T > 22 && C > 22;

  logic valid5, valid6, valid7, valid8, valid9, valid10, valid11, valid12, valid13, valid14;
  logic [ADDRESS-1:0] address5, address10, address13;
  delay #(.BITS(ADDRESS), .STAGES(1)) hold_address5 (.clk, .rst, .advance, .in(pixel_address), .out(address5));
  delay #(.BITS(ADDRESS), .STAGES(5)) hold_address10 (.clk, .rst, .advance, .in(address5), .out(address10));
  delay #(.BITS(ADDRESS), .STAGES(3)) hold_address13 (.clk, .rst, .advance, .in(address10), .out(address13));
  delay #(.BITS(SLOT_BITS), .STAGES(6)) hold_slot10 (.clk, .rst, .advance, .in(pixel_slot), .out(colour_slot));

  // Stages 4 to 8: opacity, clamped; what the rules skip by its product goes no further.
  localparam logic [PEAK+WEIGHT:0] BELOW_OPACITY = ((PEAK + WEIGHT + 1)'(1) << (OPACITY_SHIFT - 1)) - 1'b1;
  localparam OPACITY = PEAK + WEIGHT + 1 - OPACITY_SHIFT;
  logic [PEAK+WEIGHT:0] product6;
  logic [OPACITY-1:0] rounded7;
  logic skipped7;
  logic [ALPHA:0] alpha8;
  logic [17:0] low5;
  logic half6, below6;
  assign half6 = product6[OPACITY_SHIFT-1] && (!EVEN || product6[OPACITY_SHIFT] || below6 || |((product6 & BELOW_OPACITY) >> 18));
  multiply #(
      .LEFT (PEAK),
      .RIGHT(WEIGHT + 1),
      .RIGHT_UNIT(1),
      .ADDED_BITS(ADDED_BITS)
  ) opacity (
      .clk,
      .advance,
      .left(peak),
      .right(weight),
      .low(low5),
      .product(product6)
  );
  always_ff @(posedge clk)
    if (advance) begin
      below6 <= |(low5 & 18'(BELOW_OPACITY));
      rounded7 <= product6[PEAK+WEIGHT:OPACITY_SHIFT] + OPACITY'(half6);
      skipped7 <= product6 < (PEAK + WEIGHT + 1)'(rules.least);
      alpha8 <= rounded7 > OPACITY'(rules.alpha_max) ? rules.alpha_max : rounded7[ALPHA:0];
    end

  // Stages 5 to 8: the transmittance. Stages 8 to 10: the share of it that the splat takes, without its rounding.
  logic [T+1:0] transmittance8, transmittance9, transmittance10;
  logic [T+ALPHA+1:0] product10;
  logic [T:0] share10, rest10;
  localparam logic [T+ALPHA+1:0] BELOW_SHARE = ((T + ALPHA + 2)'(1) << (ALPHA - 1)) - 1'b1;
  logic [17:0] low9;
  logic half10, below10;
  assign transmittance_read_address = address5;
  multiply #(
      .LEFT (T + 1),
      .RIGHT(ALPHA + 1),
      .LEFT_UNIT(APART),
      .RIGHT_UNIT(1),
      .ADDED_BITS(ADDED_BITS)
  ) share (
      .clk,
      .advance,
      .left(transmittance8[T:0]),
      .right(alpha8),
      .low(low9),
      .product(product10)
  );
  // An opacity of at most 1 takes at most all.
  assign share10 = product10[T+ALPHA:ALPHA];
  assign half10 = product10[ALPHA-1] && (!EVEN || product10[ALPHA] || below10 || |((product10 & BELOW_SHARE) >> 18));

  // Stage 10: what is left, and beside it, not behind it, whether that is too little: rest <= minimum_transmittance, or
  // rest - minimum_transmittance - 1 < 0. a - b - c = a + ~b + !c.
  logic [T+2:0] beyond9, beyond10, under10;
  logic stop10;
  logic carry_rest, carry_under, carry_share;
  assign {rest10, carry_rest} = {transmittance10[T:0], 1'b1} + {~share10, !half10};
  assign {under10, carry_under} = {beyond10, 1'b1} + {2'b11, ~share10, !half10};
  assign stop10 = under10[T+2];
  always_ff @(posedge clk)
    if (advance) begin
      below10 <= |(low9 & 18'(BELOW_SHARE));
      transmittance8 <= transmittance_read;
      transmittance9 <= transmittance8;
      transmittance10 <= transmittance9;
      beyond9 <= {2'b00, transmittance8[T:0]} + {2'b11, ~rules.minimum_transmittance};
      beyond10 <= beyond9;
    end

  // Stage 11: its new value is written.
  logic [T:0] share11, rounded10;
  logic [17:0] share_sum11;
  assign {rounded10, carry_share} = {share10, 1'b1} + {{(T + 1) {1'b0}}, half10};
  assign transmittance_write = valid10 && !transmittance10[T+1];
  assign transmittance_write_address = address10;
  assign transmittance_word = stop10 && rules.omit_finishing ? {1'b1, transmittance10[T:0]} : {stop10, rest10};
  always_ff @(posedge clk)
    if (advance) begin
      share11 <= rounded10;
      share_sum11 <= splatline_math::halves(34'(rounded10));
    end

  // Stages 10 to 12: a transmittance of 1 says that nothing has been added to the colours, which nobody has cleared
  // (tile_colours.sv).
  logic whole11, whole12;
  always_ff @(posedge clk)
    if (advance) begin
      whole11 <= transmittance10[T];
      whole12 <= whole11;
    end

  // Stages 11 to 14: the sums. Shares of 1 in all and colours below 2^n make at most 2^n, rounded or not
  // (src/blend/mod.rs).
  logic coloured11;
  localparam logic [T+C:0] BELOW_COLOUR = ((T + C + 1)'(1) << (COLOUR_SHIFT - 1)) - 1'b1;
  logic [3*SUM-1:0] colour13;
  logic [2:0] carry_colour;
  logic unused;
  assign unused = &{1'b0, carry_rest, carry_under, carry_share, carry_colour, share_sum11, colour_sums11};
  assign colour_read_address = address10;
  assign colour_write = valid13;
  assign colour_write_address = address13;
  genvar channel;
  generate
    for (channel = 0; channel < 3; channel = channel + 1) begin : gen_channel
      logic [T+C:0] product13;
      localparam LOW = THREE ? 17 : 18;
      logic [LOW-1:0] low12;
      logic below13;
      if (THREE) begin : gen_three
        multiply_three #(
            .LEFT (T + 1),
            .RIGHT(C)
        ) layer (
            .clk,
            .advance,
            .left(share11),
            .left_sum(share_sum11),
            .right(colour11[channel*C+:C]),
            .right_sum(colour_sums11[channel*18+:18]),
            .low(low12),
            .product(product13)
        );
      end else begin : gen_usual
        multiply #(
            .LEFT (T + 1),
            .RIGHT(C),
            .LEFT_UNIT(APART)
        ) layer (
            .clk,
            .advance,
            .left(share11),
            .right(colour11[channel*C+:C]),
            .low(low12),
            .product(product13)
        );
      end
      always_ff @(posedge clk) if (advance) below13 <= |(low12 & LOW'(BELOW_COLOUR));
      logic [SUM-1:0] sum13;
      logic tie13;
      assign {sum13, carry_colour[channel]} = {colour13[channel*SUM+:SUM], 1'b1} + product13[COLOUR_SHIFT-1+:SUM+1];
      assign tie13 = EVEN && product13[COLOUR_SHIFT-1] && !below13 && ~|((product13 & BELOW_COLOUR) >> LOW);
      assign colour_word[channel*SUM+:SUM] = {sum13[SUM-1:1], sum13[0] && !tie13};
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
      valid11 <= transmittance_write;
      coloured11 <= transmittance_write && !(stop10 && rules.omit_finishing);
      valid12 <= coloured11;
      valid13 <= valid12;
      valid14 <= valid13;
    end
    if (advance) colour13 <= whole12 ? '0 : colour_read;
  end

  assign idle = !(valid5 || valid6 || valid7 || valid8 || valid9 || valid10 || valid11 || valid12 || valid13 || valid14);
endmodule
