// One term of a sum: left * right, divided by 2^31 or, if `wide`, by 2^16, rounded to nearest with halves up, and added
// to what stood before.
//
//   factors | magnitudes | product (2) | quotient | sum
//
// It is the kernel's `shift_round` (src/math/shift.rs) and the addition behind it in one adder: the quotient of a
// negative term enters as its ones' complement, and one carry is both the rounding and the rest of the negation. With a
// magnitude of 2^s q + r:
//
//   (m + 2^(s-1)) >> s = q + h               h: r is half of 2^s or more
//   (-m + 2^(s-1)) >> s = -(q + g) = ~q + !g   g: r is more than half, since halves of negative numbers go up, too
module harmonics_term #(
    parameter LEFT = 36,
    parameter RIGHT = 35
) (
    input logic clk,
    // Stages are those of harmonics_unit.sv.
    input logic signed [LEFT-1:0] left5,
    input logic signed [RIGHT-1:0] right5,
    input logic negated5,
    input logic wide5,
    input logic signed [51:0] before9,
    output logic signed [51:0] sum9
);
  localparam BITS = LEFT + RIGHT - 2;

  logic [LEFT-2:0] left6;
  logic [RIGHT-2:0] right6;
  logic negative6, negative7, negative8, negative9;
  logic wide6, wide7, wide8;
  logic [BITS-1:0] product8;
  logic half8, rest8, carry9;
  logic [49:0] quotient9;
  always_ff @(posedge clk) begin
    left6 <= left5[LEFT-1] ? -left5[LEFT-2:0] : left5[LEFT-2:0];
    right6 <= right5[RIGHT-1] ? -right5[RIGHT-2:0] : right5[RIGHT-2:0];
    negative6 <= left5[LEFT-1] ^ right5[RIGHT-1] ^ negated5;
    {negative7, negative8, negative9} <= {negative6, negative7, negative8};
    {wide6, wide7, wide8} <= {wide5, wide6, wide7};
  end
  multiply #(.LEFT(LEFT - 1), .RIGHT(RIGHT - 1)) multiplier (.clk, .advance(1'b1), .left(left6), .right(right6), .low(), .product(product8));

  assign half8 = wide8 ? product8[15] : product8[30];
  assign rest8 = |product8[14:0] || (!wide8 && |product8[29:15]);
  always_ff @(posedge clk) begin
    quotient9 <= wide8 ? 50'(product8[BITS-1:16]) : 50'(product8[BITS-1:31]);
    carry9 <= negative8 ? !(half8 && rest8) : half8;
  end
  assign sum9 = before9 + $signed({{2{negative9}}, quotient9 ^ {50{negative9}}}) + $signed({51'd0, carry9});
endmodule
