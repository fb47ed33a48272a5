// A magnitude with sign rounded to MANTISSA bits, three cycles later (`Scaled::from_wide`): halves away from minus
// infinity, as the two's complement rounds. That of 0 is 0, with any exponent.
//
//   left by sixteens | by fours | by what is left; rounding and its overflow
//
// Zeros are not counted first: each stage sees by itself how far the leading one is from the left; the second finds
// both of its own and the third's distance. Whether rounding overflows is seen beside its addition, not behind it: what
// overflows is nothing but ones.
module normalise #(
    parameter BITS = 36
) (
    input logic clk,
    input logic negative,
    input logic [BITS-1:0] magnitude,
    input logic signed [splatline_pkg::EXPONENT-1:0] exponent,
    output logic result_negative,
    output logic [splatline_pkg::MANTISSA-1:0] result,
    output logic signed [splatline_pkg::EXPONENT-1:0] result_exponent
);
  localparam M = splatline_pkg::MANTISSA;
  localparam E = splatline_pkg::EXPONENT;

  logic [63:0] wide, left1, moved1;
  logic [1:0] sixteens, fours1, ones1, ones2, sixteenth, fourth1, one1;
  logic signed [E-1:0] exponent1, exponent2;
  logic negative1, negative2;
  logic [M+3:0] top2;
  logic [M:0] moved2;
  logic [M-1:0] whole2;
  logic below2, up2, over2;

  assign wide = 64'(magnitude) << (64 - BITS);
  assign sixteenth = splatline_math::leading({|wide[63:48], |wide[47:32], |wide[31:16]});
  assign fourth1 = splatline_math::leading({|left1[63:60], |left1[59:56], |left1[55:52]});
  // Of each four bits by itself, and chosen as they are.
  always_comb begin
    case (fourth1)
      2'd3: one1 = splatline_math::leading(left1[63:61]);
      2'd2: one1 = splatline_math::leading(left1[59:57]);
      2'd1: one1 = splatline_math::leading(left1[55:53]);
      default: one1 = splatline_math::leading(left1[51:49]);
    endcase
  end
  assign {sixteens, fours1, ones1} = ~{sixteenth, fourth1, one1};
  assign moved1 = left1 << {fours1, 2'd0};
  assign moved2 = (M + 1)'((top2 << ones2) >> 3);
  // Of what is cut off, a half is rounded up, of a negative number what is more than a half. What lies below in any
  // case is known a cycle before.
  assign up2 = moved2[0] && (below2 || 3'(top2 << ones2) != 0 || !negative2);
  assign whole2 = moved2[M:1] + {{(M - 1) {1'b0}}, up2};
  assign over2 = up2 && (&moved2[M:1]);
  always_ff @(posedge clk) begin
    left1 <= wide << {sixteens, 4'd0};
    exponent1 <= exponent - E'($signed({1'b0, sixteens, 4'd0}));
    negative1 <= negative;

    top2 <= moved1[63-:M+4];
    below2 <= |moved1[63-M-4:0];
    ones2 <= ones1;
    exponent2 <= exponent1 + $signed(E'(BITS - M)) - E'($signed({1'b0, fours1, ones1}));
    negative2 <= negative1;

    // 2^M is half as much, twice.
    result <= {over2 | whole2[M-1], whole2[M-2:0]};
    result_exponent <= exponent2 + E'($signed({1'b0, over2}));
    result_negative <= negative2;
  end
endmodule
