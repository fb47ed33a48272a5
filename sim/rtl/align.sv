// value * 2^-shift in 64 bits, four cycles later: rounded to nearest to the right (halves up), saturated to the left
// (`shift_signed` of src/math/shift.rs).
//
//   sign and leading bit | distance, shift by its lowest bits | shift by eights | rounding
//
// Without SATURATES nothing may be moved out to the left, and no leading bit is looked for. With SIGNED, `magnitude` is the value itself, which then needs no negation in front of this.
//
// The value stands left of 64 zeros and is only ever moved right: one shifter for both directions, and the last bit moved out rounds.
module align #(
    parameter BITS = 18,
    parameter SIGNED = 0,
    parameter SATURATES = 1
) (
    input logic clk,
    input logic negative,
    input logic [BITS-1:0] magnitude,
    input logic signed [15:0] shift,
    output logic signed [63:0] result
);
  logic signed [BITS:0] value1;
  logic signed [BITS+7:0] value2;
  logic [6:0] length1;
  logic signed [15:0] shift1, left1;
  logic overflow2, overflow3, negative3;
  logic [2:0] ones1;
  logic [3:0] eights1;
  logic [3:0] eights2;
  logic signed [64:0] moved3;

  assign left1 = 16'sd0 - shift1;
  assign eights1 = shift1[6:3] + 4'd7 + {3'd0, shift1[2:0] != 0};
  // The length of a negative power of two is one more than its ones' complement has; there both results are the same. That of -1 has no bit left.
  logic signed [BITS:0] value;
  logic [BITS-1:0] length_of;
  generate
    if (SIGNED) begin : gen_signed
      assign value = $signed({negative, magnitude});
      assign length_of = magnitude ^ {BITS{negative}};
    end else begin : gen_magnitude
      assign value = negative ? -$signed({1'b0, magnitude}) : $signed({1'b0, magnitude});
      assign length_of = magnitude;
    end
  endgenerate
  always_ff @(posedge clk) begin
    value1 <= value;
    length1 <= splatline_math::length(64'(length_of));
    shift1 <= shift;
    // The distance is 63 more than the shift: its lowest bits.
    ones1 <= shift[2:0] - 3'd1;

    value2 <= $signed({value1, 7'd0}) >>> ones1;
    overflow2 <= SATURATES != 0 && shift1 < 0 && (length1 != 0 || value1[BITS]) && left1 + $signed({9'd0, length1}) > 16'sd63;
    // Beyond either end the lowest bits of the distance make no difference.
    eights2 <= shift1 > 16'sd64 ? 4'd15 : shift1 < -16'sd63 ? 4'd0 : eights1;

    overflow3 <= overflow2;
    negative3 <= value2[BITS+7];
    moved3 <= 65'($signed({value2, 57'd0}) >>> {eights2, 3'd0});

    if (overflow3) result <= {negative3, {63{!negative3}}};
    else result <= moved3[64:1] + $signed({63'd0, moved3[0]});
  end
endmodule
