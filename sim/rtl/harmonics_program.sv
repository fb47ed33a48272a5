// Program of the harmonics unit's basis: written by `rtl -- package` from sim/rtl/cosim/harmonics_program.txt; do not
// edit.
//
// A slot, from its lowest bit: left register (6), right register (6), target (6), constant (31), and a bit each: right
// is a register, left is clamped to 4, quotient by 2^16, subtracted, first of its sum, to a register, to a harmonic.
// `end_place` is a degree's last place; a `gap` has no term.
module harmonics_program (
    input logic clk,
    input logic [6:0] place,
    input logic [2:0] degree,
    output logic [55:0] slot,
    output logic [6:0] end_place,
    output logic gap
);
  always_comb begin
    case (degree)
      3'd0: end_place = 7'd2;
      3'd1: end_place = 7'd15;
      3'd2: end_place = 7'd33;
      3'd3: end_place = 7'd55;
      default: end_place = 7'd92;
    endcase
  end
  always_comb begin
    case (place)
      7'd3, 7'd4, 7'd5, 7'd6, 7'd7, 7'd8, 7'd18, 7'd19, 7'd20, 7'd71, 7'd87, 7'd88, 7'd89, 7'd90, 7'd91: gap = 1;
      default: gap = 0;
    endcase
  end
  always_ff @(posedge clk) begin
    case (place)
      7'd0: slot <= 56'h68000000000000;  // x = direction
      7'd1: slot <= 56'h68000000001000;  // y = direction
      7'd2: slot <= 56'h68000000002000;  // z = direction
      7'd9: slot <= 56'hb43e8a86f03000;  // -(x) root(3 / 4 pi) = Y_3
      7'd10: slot <= 56'hb43e8a86f01001;  // -(y) root(3 / 4 pi) = Y_1
      7'd11: slot <= 56'ha43e8a86f02002;  // (z) root(3 / 4 pi) = Y_2
      7'd12: slot <= 56'h62000000003000;  // (x) (x) = xx
      7'd13: slot <= 56'h42000000004041;  // + (y) (y) = xx + yy
      7'd14: slot <= 56'h42000000005082;  // + (z) (z) = rr
      7'd15: slot <= 56'h62000000006040;  // (x) (y) = xy
      7'd16: slot <= 56'h62000000007081;  // (y) (z) = yz
      7'd17: slot <= 56'h62000000008080;  // (x) (z) = xz
      7'd21: slot <= 56'h28000800000003;  // (xx) 2
      7'd22: slot <= 56'h58000400009004;  // - (xx + yy) 1 = squares
      7'd23: slot <= 56'h28000800000005;  // (rr) 2
      7'd24: slot <= 56'h58000c0000a004;  // - (xx + yy) 3 = 3 zz - rr
      7'd25: slot <= 56'ha48bd8a0804006;  // (xy) root(15 / 4 pi) = Y_4
      7'd26: slot <= 56'hb48bd8a0805007;  // -(yz) root(15 / 4 pi) = Y_5
      7'd27: slot <= 56'hb48bd8a0807008;  // -(xz) root(15 / 4 pi) = Y_7
      7'd28: slot <= 56'h28001000000003;  // (xx) 4
      7'd29: slot <= 56'h58000c0000b004;  // - (xx + yy) 3 = three_x
      7'd30: slot <= 56'h28001000000003;  // (xx) 4
      7'd31: slot <= 56'h5800040000c004;  // - (xx + yy) 1 = three_y
      7'd32: slot <= 56'ha445ec50408009;  // (squares) root(15 / 16 pi) = Y_8
      7'd33: slot <= 56'ha4285ec034600a;  // (3 zz - rr) root(5 / 16 pi) = Y_6
      7'd34: slot <= 56'h28001000000005;  // (rr) 4
      7'd35: slot <= 56'h5800140000d004;  // - (xx + yy) 5 = five
      7'd36: slot <= 56'h28000800000005;  // (rr) 2
      7'd37: slot <= 56'h5800140000e004;  // - (xx + yy) 5 = 5 zz - 3 rr
      7'd38: slot <= 56'h6200000000f086;  // (xy) (z) = xyz
      7'd39: slot <= 56'h62000000010089;  // (squares) (z) = z squares
      7'd40: slot <= 56'h6200000001104c;  // (three_y) (y) = y three_y
      7'd41: slot <= 56'h6200000001200b;  // (three_x) (x) = x three_x
      7'd42: slot <= 56'h28000400000005;  // (rr) 1
      7'd43: slot <= 56'h58001c00013004;  // - (xx + yy) 7 = 7 zz - 6 rr
      7'd44: slot <= 56'h6200000001404d;  // (five) (y) = y five
      7'd45: slot <= 56'h6200000001500d;  // (five) (x) = x five
      7'd46: slot <= 56'h6200000001608e;  // (5 zz - 3 rr) (z) = z (5 zz - 3 rr)
      7'd47: slot <= 56'ha571ff8e44a00f;  // (xyz) root(105 / 4 pi) = Y_10
      7'd48: slot <= 56'ha4b8ffc724e010;  // (z squares) root(105 / 16 pi) = Y_14
      7'd49: slot <= 56'hb44b868c609011;  // -(y three_y) root(35 / 32 pi) = Y_9
      7'd50: slot <= 56'hb44b868c60f012;  // -(x three_x) root(35 / 32 pi) = Y_15
      7'd51: slot <= 56'h28001400000005;  // (rr) 5
      7'd52: slot <= 56'h58001400017004;  // - (xx + yy) 5 = 5 zz
      7'd53: slot <= 56'hb43a807a0cb014;  // -(y five) root(21 / 32 pi) = Y_11
      7'd54: slot <= 56'hb43a807a0cd015;  // -(x five) root(21 / 32 pi) = Y_13
      7'd55: slot <= 56'ha42fc43df8c016;  // (z (5 zz - 3 rr)) root(7 / 16 pi) = Y_12
      7'd56: slot <= 56'h68000c00018005;  // (rr) 3 = 3 rr
      7'd57: slot <= 56'h28000400000004;  // (xx + yy) 1
      7'd58: slot <= 56'h58000400019003;  // - (xx) 1 = yy
      7'd59: slot <= 56'h28001800000005;  // (rr) 6
      7'd60: slot <= 56'h58001c0001a004;  // - (xx + yy) 7 = seven
      7'd61: slot <= 56'h6200000001b5d3;  // (7 zz - 6 rr) (5 zz) = zero, zz
      7'd62: slot <= 56'h28001000000005;  // (rr) 4
      7'd63: slot <= 56'h58001c0001c004;  // - (xx + yy) 7 = odd
      7'd64: slot <= 56'h6200000001d246;  // (xy) (squares) = xy squares
      7'd65: slot <= 56'h6200000001e158;  // (3 rr) (rr) = zero, rr
      7'd66: slot <= 56'h6200000001f1cc;  // (three_y) (yz) = yz three_y
      7'd67: slot <= 56'h6200000002064c;  // (three_y) (yy) = yy three_y
      7'd68: slot <= 56'h6200000002120b;  // (three_x) (xz) = xz three_x
      7'd69: slot <= 56'h6200000002219a;  // (seven) (xy) = xy seven
      7'd70: slot <= 56'h6200000002325a;  // (seven) (squares) = squares seven
      7'd72: slot <= 56'h620000000241dc;  // (odd) (yz) = yz odd
      7'd73: slot <= 56'h2800040000001b;  // (zero, zz) 1
      7'd74: slot <= 56'h4800040002501e;  // + (zero, rr) 1 = twice zero
      7'd75: slot <= 56'h220000000000cb;  // (three_x) (xx)
      7'd76: slot <= 56'h58000400026020;  // - (yy three_y) 1 = four
      7'd77: slot <= 56'h6200000002721c;  // (odd) (xz) = xz odd
      7'd78: slot <= 56'ha5406d8aa1001d;  // (xy squares) root(315 / 16 pi) = Y_16
      7'd79: slot <= 56'hb4e293a525101f;  // -(yz three_y) root(315 / 32 pi) = Y_17
      7'd80: slot <= 56'ha4791c40a12022;  // (xy seven) root(45 / 16 pi) = Y_18
      7'd81: slot <= 56'hb455a351313024;  // -(yz odd) root(45 / 32 pi) = Y_19
      7'd82: slot <= 56'ha43c8e20516023;  // (squares seven) root(45 / 64 pi) = Y_22
      7'd83: slot <= 56'h68000200028025;  // (twice zero) 1 / 2 = zero
      7'd84: slot <= 56'hb4e293a5257021;  // -(xz three_x) root(315 / 32 pi) = Y_23
      7'd85: slot <= 56'ha4501b62a98026;  // (four) root(315 / 256 pi) = Y_24
      7'd86: slot <= 56'hb455a351315027;  // -(xz odd) root(45 / 32 pi) = Y_21
      7'd92: slot <= 56'ha41b14c2f94028;  // (zero) root(9 / 64 pi) = Y_20
      default: slot <= 56'd0;
    endcase
  end
endmodule
