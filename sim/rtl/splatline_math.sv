// Arithmetic of the kernel's `math` module, defined for every bit pattern: shifts that round to nearest (halves up) or saturate,
// and the position of the leading bit. One function per function of src/math/shift.rs, so that both can be read side by side.
package splatline_math;

  // value / 2^shift, rounded to nearest, halves up; 0 from 64 on.
  function automatic logic signed [63:0] shift_round(input logic signed [63:0] value, input logic [6:0] shift);
    logic signed [63:0] half;
    half = 64'sd1 <<< (shift - 7'd1);
    if (shift == 0) shift_round = value;
    else if (shift[6]) shift_round = 64'sd0;
    else shift_round = (value + half) >>> shift[5:0];
  endfunction

  // value * 2^-shift: rounds to the right, saturates to the left.
  function automatic logic signed [63:0] shift_signed(input logic signed [63:0] value, input logic signed [15:0] shift);
    logic [15:0] left;
    logic signed [63:0] shifted;
    logic signed [63:0] back;
    left = 16'd0 - shift;
    shifted = value <<< left[5:0];
    back = shifted >>> left[5:0];
    if (!shift[15]) shift_signed = shift_round(value, shift > 64 ? 7'd64 : shift[6:0]);
    else if (value == 0) shift_signed = 64'sd0;
    else if (left < 64 && back == value) shift_signed = shifted;
    else shift_signed = {value[63], {63{!value[63]}}};
  endfunction

  // Bits that a magnitude needs: 64 minus the leading zeros.
  function automatic logic [6:0] length(input logic [63:0] magnitude);
    length = 0;
    for (int i = 0; i < 64; i = i + 1)
      if (magnitude[i]) length = i[6:0] + 7'd1;
  endfunction

endpackage
