// Product and sum of floating-point numbers of any format: sign, E bits of exponent, F of fraction, rounded to nearest,
// ties to even. What is below the normal numbers is 0 and what is beyond them infinite: as small as such units get.

module float_multiply #(parameter int E = 5, parameter int F = 10) (
    input logic [E+F:0] a, b,
    output logic [E+F:0] y
);
    localparam int BIAS = (1 << E - 1) - 1;
    localparam int LAST = (1 << E) - 1;
    wire [2*F+1:0] product = {1'b1, a[F-1:0]} * {1'b1, b[F-1:0]};
    wire high = product[2*F+1];
    wire [2*F+1:0] kept = high ? product : product << 1;
    wire up = kept[F] & (kept[F+1] | (kept[F-1:0] != 0));
    wire [F+1:0] rounded = {1'b0, kept[2*F+1:F+1]} + (F+2)'(up);
    wire signed [E+2:0] exponent = (E+3)'(a[E+F-1:F]) + (E+3)'(b[E+F-1:F]) + (E+3)'(high) + (E+3)'(rounded[F+1]) - (E+3)'(BIAS);
    wire zero = a[E+F-1:F] == 0 || b[E+F-1:F] == 0 || exponent <= 0;
    wire beyond = exponent >= (E+3)'(LAST);
    assign y = {a[E+F] ^ b[E+F], zero ? (E+F)'(0) : beyond ? {{E{1'b1}}, F'(0)} : {exponent[E-1:0], rounded[F-1:0]}};
endmodule

module float_add #(parameter int E = 5, parameter int F = 10) (
    input logic [E+F:0] a, b,
    output logic [E+F:0] y
);
    localparam int LAST = (1 << E) - 1;
    localparam int W = F + 4; // Leading one, fraction, guard, round, sticky.
    wire swap = b[E+F-1:0] > a[E+F-1:0];
    wire [E+F:0] big = swap ? b : a, little = swap ? a : b;
    wire [E-1:0] apart = big[E+F-1:F] - little[E+F-1:F];
    wire [W-1:0] first = {big[E+F-1:F] != 0, big[F-1:0], 3'b0};
    wire [W-1:0] second = {little[E+F-1:F] != 0, little[F-1:0], 3'b0};
    wire [W-1:0] shifted = second >> apart;
    wire lost = (shifted << apart) != second;
    wire [W-1:0] other = {shifted[W-1:1], shifted[0] | lost};
    wire [W:0] sum = big[E+F] ^ little[E+F] ? {1'b0, first} - {1'b0, other} : {1'b0, first} + {1'b0, other};
    logic [W:0] normal;
    logic [E+1:0] zeros;
    always_comb begin
        zeros = 0;
        normal = sum;
        for (int step = $clog2(W + 1) - 1; step >= 0; step--)
            if (normal >> (W + 1 - (1 << step)) == 0) begin
                normal = normal << (1 << step);
                zeros = zeros + (E+2)'(1 << step);
            end
    end
    wire up = normal[3] & (normal[4] | (normal[2:0] != 0));
    wire [F+1:0] rounded = {1'b0, normal[W:4]} + (F+2)'(up);
    wire signed [E+2:0] exponent = (E+3)'(big[E+F-1:F]) + (E+3)'(1) + (E+3)'(rounded[F+1]) - (E+3)'(zeros);
    wire zero = !normal[W] || exponent <= 0;
    wire beyond = exponent >= (E+3)'(LAST);
    assign y = {big[E+F], zero ? (E+F)'(0) : beyond ? {{E{1'b1}}, F'(0)} : {exponent[E-1:0], rounded[F-1:0]}};
endmodule

module fixed_multiply #(parameter int A = 8, parameter int B = 8) (
    input logic [A-1:0] a,
    input logic [B-1:0] b,
    output logic [A+B-1:0] y
);
    assign y = a * b;
endmodule

module fixed_add #(parameter int A = 8) (
    input logic [A-1:0] a, b,
    output logic [A-1:0] y
);
    assign y = a + b;
endmodule
