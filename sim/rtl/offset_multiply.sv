// value * factor for a factor in 0 ..= 2^BITS, for multipliers that are signed.
//
// As it stands the factor needs BITS + 2 bits there; lowered by half its range it fits into BITS, and the rest is an addition:
// value * factor = value * (factor - 2^(BITS-1)) + value * 2^(BITS-1). Only 2^BITS itself has no place, and that is a shift. A
// factor of 18 bits thus takes one column of 18-bit multipliers, not two.
module offset_multiply #(
    parameter VALUE = 27,
    parameter BITS = 18
) (
    input logic [VALUE-1:0] value,
    input logic [BITS:0] factor,
    output logic [VALUE+BITS-1:0] product  // at most value * 2^BITS
);
  logic signed [VALUE:0] whole;
  logic signed [BITS-1:0] lowered;
  logic signed [VALUE+BITS:0] partial;

  assign whole = $signed({1'b0, value});
  assign lowered = $signed({!factor[BITS-1], factor[BITS-2:0]});
  assign partial = whole * lowered;
  assign product = factor[BITS] ? {value, {BITS{1'b0}}} : $unsigned(partial[VALUE+BITS-1:0]) + {1'b0, value, {(BITS - 1) {1'b0}}};
endmodule
