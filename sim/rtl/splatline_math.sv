// Arithmetic of the kernel's `math` module, defined for every bit pattern: shifts that round to nearest (halves up) or saturate,
// and the position of the leading bit. One function per function of src/math/shift.rs, so that both can be read side by side.
package splatline_math;

  // value / 2^shift, rounded to nearest, halves up; 0 from 64 on. The last bit shifted out is the one that rounds, so that one shifter
  // and an increment do.
  function automatic logic signed [63:0] shift_round(input logic signed [63:0] value, input logic [6:0] shift);
    logic [5:0] but_one;
    logic signed [63:0] doubled;
    but_one = shift[5:0] - 6'd1;
    doubled = value >>> but_one;
    if (shift == 0) shift_round = value;
    else if (shift[6]) shift_round = 64'sd0;
    else shift_round = (doubled >>> 1) + $signed({63'd0, doubled[0]});
  endfunction

  // value * 2^-shift: rounds to the right, saturates to the left. The length of the ones' complement is that of the magnitude, but for
  // negative powers of two, one less; there the exact result and the saturated one are the same.
  function automatic logic signed [63:0] shift_signed(input logic signed [63:0] value, input logic signed [15:0] shift);
    logic [15:0] left;
    logic overflow;
    left = 16'd0 - shift;
    overflow = value != 0 && left + {9'd0, length(value[63] ? ~value : value)} > 16'd63;
    if (!shift[15]) shift_signed = shift_round(value, shift > 64 ? 7'd64 : shift[6:0]);
    else if (overflow) shift_signed = {value[63], {63{!value[63]}}};
    else shift_signed = value <<< left[5:0];
  endfunction

  // Bits that a magnitude needs: 64 minus the leading zeros.
  function automatic logic [6:0] length(input logic [63:0] magnitude);
    length = 0;
    for (int i = 0; i < 64; i = i + 1)
      if (magnitude[i]) length = i[6:0] + 7'd1;
  endfunction

endpackage
