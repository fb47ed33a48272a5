// value * 2^-shift in 64 bits, four cycles later: rounded to nearest to the right (halves up), saturated to the left
// (`shift_signed` of src/math/shift.rs).
//
//   sign | shift by the distance's lowest bits | shift by eights; what it moves out to the left | rounding
//
// Without SATURATES nothing may be moved out to the left, and nobody looks. With SIGNED, `magnitude` is the value
// itself, which then needs no negation in front of this.
//
// The value stands left of 64 zeros and is only ever moved right: one shifter for both directions, and the last bit
// moved out rounds. What stays left of the result's sign must equal it; that is known for every number of eights at
// once, without a count of leading zeros.
module align #(
    parameter BITS = 18,
    parameter SHIFT = 16,
    parameter SIGNED = 0,
    parameter SATURATES = 1
) (
    input logic clk,
    input logic negative,
    input logic [BITS-1:0] magnitude,
    input logic signed [SHIFT-1:0] shift,
    output logic signed [63:0] result
);
  logic signed [BITS:0] value1;
  logic signed [BITS+7:0] value2;
  logic signed [SHIFT-1:0] shift1;
  logic beyond1, far1, far2, overflow3, negative3;
  logic [2:0] ones1;
  logic [3:0] eights1;
  logic [3:0] eights2;
  logic signed [64:0] moved3;

  // shift > 64 and shift < -63, by its bits: a comparison would take a carry.
  assign beyond1 = !shift1[SHIFT-1] && (shift1[SHIFT-2:7] != 0 || (shift1[6] && shift1[5:0] != 0));
  assign far1 = shift1[SHIFT-1] && (!(&shift1[SHIFT-2:6]) || shift1[5:0] == 0);
  assign eights1 = shift1[6:3] + 4'd7 + {3'd0, shift1[2:0] != 0};
  logic signed [BITS:0] value;
  generate
    if (SIGNED) begin : gen_signed
      assign value = $signed({negative, magnitude});
    end else begin : gen_magnitude
      assign value = $signed({1'b0, magnitude} ^ {(BITS + 1) {negative}}) + $signed({{BITS{1'b0}}, negative});
    end
  endgenerate

  // Of a shift by so many eights: does a bit from the result's sign on differ from the value's?
  localparam EIGHTS = (BITS + 7) / 8;
  logic [15:0] differs2;
  always_comb begin
    differs2 = 16'd0;
    for (int i = EIGHTS - 1; i >= 0; i = i - 1) begin
      differs2[i] = differs2[i+1];
      for (int j = 7; j < 15; j = j + 1) if (8 * i + j < BITS + 7) differs2[i] = differs2[i] || value2[8*i+j] != value2[BITS+7];
    end
  end
  always_ff @(posedge clk) begin
    value1 <= value;
    shift1 <= shift;
    // The distance is 63 more than the shift: its lowest bits.
    ones1 <= shift[2:0] - 3'd1;

    value2 <= $signed({value1, 7'd0}) >>> ones1;
    far2 <= far1;
    // Beyond either end the lowest bits of the distance make no difference.
    eights2 <= beyond1 ? 4'd15 : far1 ? 4'd0 : eights1;

    overflow3 <= SATURATES != 0 && (differs2[eights2] || (far2 && value2 != 0));
    negative3 <= value2[BITS+7];
    moved3 <= 65'($signed({value2, 57'd0}) >>> {eights2, 3'd0});

    if (overflow3) result <= {negative3, {63{!negative3}}};
    else result <= moved3[64:1] + $signed({63'd0, moved3[0]});
  end
endmodule
