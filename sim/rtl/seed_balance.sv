// `Balance::new` of src/raster/seeds.rs, four cycles: the second difference of a quadratic sequence, and what meets its
// rounding in the seed of a block. Arithmetic modulo 2^BITS; what the rounding leaves is less than a unit.
module seed_balance #(
    parameter BITS = 32
) (
    input logic clk,
    input logic signed [63:0] fine,  // A or C with GUARD bits below the sequence's unit
    output logic [BITS-1:0] second,
    output logic [BITS-1:0] unit,
    output logic [BITS-1:0] start
);
  localparam BLOCK_BITS = splatline_pkg::BLOCK_BITS;
  localparam GUARD = splatline_pkg::GUARD;
  localparam WIDE = BITS + GUARD + 1;
  localparam signed [WIDE-1:0] HALF = (WIDE)'(1) << (GUARD - 1);

  logic signed [WIDE-1:0] fine1, second1, rounded2, balanced3, start3;
  logic [BITS-1:0] second2, second3;
  logic signed [GUARD:0] excess2;
  always_ff @(posedge clk) begin
    fine1 <= WIDE'(fine);
    second1 <= WIDE'(splatline_math::shift_round(fine, 7'(GUARD - 1)));
    excess2 <= (GUARD + 1)'((second1 <<< (GUARD - 1)) - fine1);
    rounded2 <= second1 <<< (GUARD - 1);
    second2 <= BITS'(second1);
    balanced3 <= rounded2 - (WIDE'(excess2) <<< BLOCK_BITS);
    start3 <= (WIDE'(excess2) <<< (2 * BLOCK_BITS - 3)) + HALF;
    second3 <= second2;
    unit <= BITS'((balanced3 + HALF) >>> GUARD);
    start <= BITS'(start3 >>> GUARD);
    second <= second3;
  end
endmodule
