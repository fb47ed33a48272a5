// A magnitude with sign rounded to MANTISSA bits, three cycles later (`Scaled::from_wide`): halves away from minus infinity, as the
// two's complement rounds.
//
//   ones' complement and leading bit | shift by an even number | by one more; rounding and its overflow
module normalise #(
    parameter BITS = 36
) (
    input logic clk,
    input logic negative,
    input logic [BITS-1:0] magnitude,
    input logic signed [15:0] exponent,
    output logic result_negative,
    output logic [splatline_pkg::MANTISSA-1:0] result,
    output logic signed [15:0] result_exponent
);
  localparam M = splatline_pkg::MANTISSA;

  logic signed [BITS:0] value1;
  logic [6:0] length1;
  logic signed [15:0] exponent1, exponent2;
  logic negative1, negative2;
  logic [M+2:0] even2;
  logic odd2;
  logic [M+1:0] moved2;
  logic [M:0] whole2;

  assign moved2 = odd2 ? even2[M+2:1] : even2[M+1:0];
  // Back to a magnitude in the same addition: -(q + d) = ~q + !d.
  assign whole2 = (negative2 ? ~moved2[M+1:1] : moved2[M+1:1]) + {{M{1'b0}}, moved2[0] != negative2};
  always_ff @(posedge clk) begin
    value1 <= negative ? -$signed({1'b0, magnitude}) : $signed({1'b0, magnitude});
    length1 <= splatline_math::length(64'(magnitude));
    exponent1 <= exponent;
    negative1 <= negative;

    // Moved from left of M + 1 zeros, so that M bits and the one that rounds are left.
    even2 <= (M + 3)'($signed({value1, {(M + 1) {1'b0}}}) >>> {length1[6:1], 1'b0});
    odd2 <= length1[0];
    exponent2 <= exponent1 + $signed({9'd0, length1}) - $signed(16'(M));
    negative2 <= negative1;

    // 2^M is half as much, twice.
    result <= {whole2[M] | whole2[M-1], whole2[M-2:0]};
    result_exponent <= whole2[M] ? exponent2 + 16'sd1 : exponent2;
    result_negative <= negative2;
  end
endmodule
