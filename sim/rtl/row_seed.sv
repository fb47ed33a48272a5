// What a run of pixels begins with, without its constants: A dx, of which the lane's first difference is made, and
// A dx^2, its radial index (`Seed::at` of src/raster/seeds.rs).
//
//   dx, A | A dx (2) | rounded to a mantissa | A dx^2 (2)
//                    `-> first difference (4)          `-> radial index (4)
//
// With an interval of 2 rows come in every other cycle. Then both products are one circuit and both alignments are,
// since the second of each is an odd number of cycles behind the first: A dx in cycles of `phase` 0, A dx^2 in the
// others. Nor is there saturation there, or with three multipliers: in a run of a packet of setup, where dx is at most
// the half-width, A dx^2 is about the cut-off at most, and A dx below 2^26, dx being 0 or at least 2^-20. A name's
// number is the row generator's stage.
module row_seed #(
    parameter INTERVAL = 1,
    parameter THREE = 0  // with the interval of 1: products by three multipliers (multiply_three.sv)
) (
    input logic clk,
    input logic rst,
    input logic phase,
    // dx as a magnitude, before it is registered, and A, with the interval of 1 and four multipliers a cycle later.
    input logic [splatline_pkg::MANTISSA:0] dx21,
    input logic [splatline_pkg::MANTISSA-1:0] horizontal,
    input logic negative24,
    input logic signed [splatline_pkg::EXPONENT-1:0] drop_first24,
    input logic signed [splatline_pkg::EXPONENT-1:0] drop_radial27,
    output logic [31:0] first28,
    output logic [31:0] radial31
);
  localparam M = splatline_pkg::MANTISSA;
  localparam E = splatline_pkg::EXPONENT;

  // Stage 25: A dx rounded to a mantissa, halves up, whatever the sign.
  logic [2*M:0] along24, along_rounded24;
  logic [M:0] slant24;
  assign along_rounded24 = along24 + (negative24 ? (2 * M + 1)'((1 << (M - 1)) - 1) : (2 * M + 1)'(1 << (M - 1)));
  assign slant24 = along_rounded24[2*M:M];

  // A dx^2 is never negative.
  logic [2*M+1:0] across27;
  logic signed [63:0] first, radial;
  assign {first28, radial31} = {first[31:0], radial[31:0]};
  generate
    if (INTERVAL == 1 && THREE) begin : gen_three
      logic [M:0] dx22, dx25, slant25;
      logic [M-1:0] horizontal22;
      logic [17:0] dx_sum22, dx_sum25, slant_sum25, horizontal_sum22;
      always_ff @(posedge clk) begin
        dx22 <= dx21;
        dx_sum22 <= splatline_math::halves(34'(dx21));
        horizontal22 <= horizontal;
        horizontal_sum22 <= splatline_math::halves(34'(horizontal));
        slant25 <= slant24;
        slant_sum25 <= splatline_math::halves(34'(slant24));
      end
      delay #(.BITS(M + 19), .STAGES(3)) hold_dx (.clk, .rst, .advance(1'b1), .in({dx_sum22, dx22}), .out({dx_sum25, dx25}));
      multiply_three #(.LEFT(M + 1), .RIGHT(M)) multiply_along (.clk, .advance(1'b1), .left(dx22), .left_sum(dx_sum22), .right(horizontal22), .right_sum(horizontal_sum22), .low(), .product(along24));
      multiply_three #(.LEFT(M + 1), .RIGHT(M + 1)) multiply_across (.clk, .advance(1'b1), .left(slant25), .left_sum(slant_sum25), .right(dx25), .right_sum(dx_sum25), .low(), .product(across27));
      align #(.BITS(2 * M + 1), .SHIFT(E), .SATURATES(0)) align_first (.clk, .negative(negative24), .magnitude(along24), .shift(drop_first24), .result(first));
      align #(.BITS(2 * M + 2), .SHIFT(E), .SATURATES(0)) align_radial (.clk, .negative(1'b0), .magnitude(across27), .shift(drop_radial27), .result(radial));
    end else if (INTERVAL == 1) begin : gen_two
      logic [M:0] dx22, dx25, slant25;
      always_ff @(posedge clk) begin
        dx22 <= dx21;
        slant25 <= slant24;
      end
      delay #(.BITS(M + 1), .STAGES(3)) hold_dx (.clk, .rst, .advance(1'b1), .in(dx22), .out(dx25));
      multiply #(.LEFT(M + 1), .RIGHT(M)) multiply_along (.clk, .advance(1'b1), .left(dx22), .right(horizontal), .low(), .product(along24));
      multiply #(.LEFT(M + 1), .RIGHT(M + 1)) multiply_across (.clk, .advance(1'b1), .left(slant25), .right(dx25), .low(), .product(across27));
      align #(.BITS(2 * M + 1), .SHIFT(E)) align_first (.clk, .negative(negative24), .magnitude(along24), .shift(drop_first24), .result(first));
      align #(.BITS(2 * M + 2), .SHIFT(E)) align_radial (.clk, .negative(1'b0), .magnitude(across27), .shift(drop_radial27), .result(radial));
    end else begin : gen_one
      logic [M:0] left, right, dx24;
      always_ff @(posedge clk) begin
        left <= phase ? dx21 : slant24;
        right <= phase ? {1'b0, horizontal} : dx24;
      end
      delay #(.BITS(M + 1), .STAGES(2)) hold_dx (.clk, .rst, .advance(1'b1), .in(left), .out(dx24));
      multiply #(.LEFT(M + 1), .RIGHT(M + 1)) multiply_both (.clk, .advance(1'b1), .left(left), .right(right), .low(), .product(across27));
      assign along24 = across27[2*M:0];
      align #(.BITS(2 * M + 2), .SHIFT(E), .SATURATES(0)) align_both (.clk, .negative(negative24 && !phase), .magnitude(across27), .shift(phase ? drop_radial27 : drop_first24), .result(first));
      assign radial = first;
    end
  endgenerate
endmodule
