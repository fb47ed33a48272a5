// Arithmetic of the kernel's `math` module, defined for every bit pattern: shifts that round to nearest (halves up) or
// saturate, and the position of the leading bit. One function per function of src/math/shift.rs, so that both can be
// read side by side.
package splatline_math;

  // value / 2^shift, rounded to nearest, halves up; 0 from 64 on. The last bit shifted out is the one that rounds, so
  // that one shifter and an increment do.
  function automatic logic signed [63:0] shift_round(input logic signed [63:0] value, input logic [6:0] shift);
    logic [5:0] but_one;
    logic signed [63:0] doubled;
    but_one = shift[5:0] - 6'd1;
    doubled = value >>> but_one;
    if (shift == 0) shift_round = value;
    else if (shift[6]) shift_round = 64'sd0;
    else shift_round = (doubled >>> 1) + $signed({63'd0, doubled[0]});
  endfunction

  // value * 2^-shift: rounds to the right, saturates to the left. The length of the ones' complement is that of the
  // magnitude, but for negative powers of two, one less; there the exact result and the saturated one are the same.
  function automatic logic signed [63:0] shift_signed(input logic signed [63:0] value, input logic signed [15:0] shift);
    logic [15:0] left;
    logic overflow;
    left = 16'd0 - shift;
    overflow = value != 0 && left + {9'd0, length(value[63] ? ~value : value)} > 16'd63;
    if (!shift[15]) shift_signed = shift_round(value, shift > 64 ? 7'd64 : shift[6:0]);
    else if (overflow) shift_signed = {value[63], {63{!value[63]}}};
    else shift_signed = value <<< left[5:0];
  endfunction

  // Bits that a magnitude needs: 64 minus the leading zeros, which is the place of the leading one if another one is
  // appended. A tree of fours, since a chain through all bits would be a long way.
  function automatic logic [6:0] length(input logic [63:0] magnitude);
    logic [63:0] word;
    logic [15:0] fours;
    logic [31:0] in_four;
    logic [15:0] of_sixteen;
    logic [3:1] sixteens;
    logic [7:0] four;
    logic [1:0] sixteen;
    word = {magnitude[62:0], 1'b1};
    for (int i = 0; i < 16; i = i + 1) begin
      fours[i] = |word[4*i+:4];
      in_four[2*i+:2] = leading(word[4*i+1+:3]);
    end
    for (int i = 0; i < 4; i = i + 1) begin
      if (i > 0) sixteens[i] = |fours[4*i+:4];
      four[2*i+:2] = leading(fours[4*i+1+:3]);
      of_sixteen[4*i+:4] = {four[2*i+:2], pick(four[2*i+:2], in_four[8*i+:8])};
    end
    sixteen = leading(sixteens);
    length = {1'b0, sixteen, pick(sixteen, {of_sixteen[15:14], of_sixteen[11:10], of_sixteen[7:6], of_sixteen[3:2]}), pick(sixteen, {of_sixteen[13:12], of_sixteen[9:8], of_sixteen[5:4], of_sixteen[1:0]})};
    if (magnitude[63]) length = 7'd64;
  endfunction

  // The place of the leading one of four bits, of which the lowest need not be seen.
  function automatic logic [1:0] leading(input logic [2:0] bits);
    leading = {bits[2] | bits[1], bits[2] | (bits[0] & ~bits[1])};
  endfunction

  // One of four pairs of bits.
  function automatic logic [1:0] pick(input logic [1:0] place, input logic [7:0] pairs);
    pick = place[1] ? (place[0] ? pairs[7:6] : pairs[5:4]) : (place[0] ? pairs[3:2] : pairs[1:0]);
  endfunction

  // A colour of 28 fraction bits without the last `drop`, in `bits` of them: halves go to the even neighbour; what is
  // beyond the range becomes its largest number.
  function automatic logic [31:0] shaded(input logic [31:0] value, input logic [4:0] drop, input logic [5:0] bits);
    logic [32:0] nearest;
    logic [31:0] lost;
    nearest = {1'b0, value >> drop};
    lost = value << (6'd32 - {1'b0, drop});
    if (lost[31] && (lost[30:0] != 0 || nearest[0])) nearest = nearest + 1'b1;
    shaded = nearest >> bits != 0 ? 32'hffffffff : nearest[31:0];
  endfunction

  // So many times a number, by sums: for a small constant, which synthesis would give a multiplier that the lanes need.
  function automatic logic [31:0] times(input logic [31:0] number, input logic [3:0] factor);
    times = 0;
    for (int i = 0; i < 4; i = i + 1) if (factor[i]) times = times + (number << i);
  endfunction

  // The sum of a factor's halves of 17 bits, for multiply_three.sv.
  function automatic logic [17:0] halves(input logic [33:0] factor);
    halves = {1'b0, factor[33:17]} + {1'b0, factor[16:0]};
  endfunction

endpackage
