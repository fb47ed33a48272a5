// left * right, two cycles later, unsigned, of factors of 18 to 34 bits by three multipliers where multiply.sv takes
// four (Karatsuba and Ofman, 1962): with halves of 17 bits
//
//   left * right = high * 2^34 + (sums - high - low) * 2^17 + low
//
// where `high` and `low` are the products of upper and of lower halves, and `sums` that of both factors' sums of
// halves, which come in beside the factors (`halves` of splatline_math.sv): a sum in front of a multiplier would take
// the cycle. It takes some 60 look-up tables of an ECP5 more, one addition among them, which is beside the others.
//
// The product's lowest 17 bits are there a cycle before it.
module multiply_three #(
    parameter LEFT = 34,
    parameter RIGHT = 34
) (
    input logic clk,
    input logic advance,
    input logic [LEFT-1:0] left,
    input logic [17:0] left_sum,
    input logic [RIGHT-1:0] right,
    input logic [17:0] right_sum,
    output logic [16:0] low,
    output logic [LEFT+RIGHT-1:0] product
);
  localparam HALF = 17;
  // Bits of the product of the upper halves, and of all but the lowest half.
  localparam HIGH = LEFT + RIGHT - 2 * HALF;
  localparam UPPER = HIGH + HALF;
  generate
    if (LEFT <= HALF || LEFT > 2 * HALF || RIGHT <= HALF || RIGHT > 2 * HALF) begin : gen_illegal_factors
      $error("multiply_three: factors must have 18 to 34 bits");
    end
  endgenerate

  logic [HIGH-1:0] highs;
  logic [2*HALF-1:0] lows;
  logic [2*HALF+1:0] sums;
  logic [UPPER-1:0] above, taken;
  assign low = lows[HALF-1:0];
  // Inverted twice: of several numbers in one sum Yosys makes two first, without a carry, which takes more look-up
  // tables than additions do.
  assign above = ~({highs, lows[2*HALF-1:HALF]} + UPPER'(sums));
  assign taken = ~(UPPER'(highs) + UPPER'(lows));
  always_ff @(posedge clk)
    if (advance) begin
      highs <= left[LEFT-1:HALF] * right[RIGHT-1:HALF];
      lows <= left[HALF-1:0] * right[HALF-1:0];
      sums <= left_sum * right_sum;
      product <= {~above - ~taken, low};
    end
endmodule
