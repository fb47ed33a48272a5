// normalise.sv, four cycles; see turn.sv.
module shared_normalise #(
    parameter BITS = 41,
    parameter INTERVAL = 4,
    parameter [3:0] USED = 4'b1111
) (
    input logic clk,
    input logic [1:0] phase,
    input logic [3:0] negative,
    input logic [4*BITS-1:0] magnitude,
    input logic [4*splatline_pkg::EXPONENT-1:0] exponent,
    output logic [3:0] result_negative,
    output logic [4*splatline_pkg::MANTISSA-1:0] result,
    output logic [4*splatline_pkg::EXPONENT-1:0] result_exponent
);
  localparam M = splatline_pkg::MANTISSA;
  localparam E = splatline_pkg::EXPONENT;
  localparam UNITS = INTERVAL == 4 ? 1 : 4;
  logic [UNITS-1:0] negatives;
  logic [UNITS*BITS-1:0] magnitudes;
  logic [UNITS*E-1:0] exponents;
  turn #(.BITS(1), .INTERVAL(INTERVAL)) turn_negative (.clk, .phase, .in(negative), .out(negatives));
  turn #(.BITS(BITS), .INTERVAL(INTERVAL)) turn_magnitude (.clk, .phase, .in(magnitude), .out(magnitudes));
  turn #(.BITS(E), .INTERVAL(INTERVAL)) turn_exponent (.clk, .phase, .in(exponent), .out(exponents));
  genvar i;
  generate
    if (INTERVAL == 4) begin : gen_one
      logic only_negative;
      logic [M-1:0] only;
      logic [E-1:0] only_exponent;
      normalise #(.BITS(BITS)) unit (.clk, .negative(negatives), .magnitude(magnitudes), .exponent(exponents), .result_negative(only_negative), .result(only), .result_exponent(only_exponent));
      assign result_negative = {4{only_negative}};
      assign result = {4{only}};
      assign result_exponent = {4{only_exponent}};
    end else begin : gen_all
      for (i = 0; i < 4; i = i + 1) begin : gen_stage
        if (USED[i]) begin : gen_used
          normalise #(.BITS(BITS)) unit (.clk, .negative(negatives[i]), .magnitude(magnitudes[i*BITS+:BITS]), .exponent(exponents[i*E+:E]), .result_negative(result_negative[i]), .result(result[i*M+:M]), .result_exponent(result_exponent[i*E+:E]));
        end else begin : gen_unused
          assign result_negative[i] = 0;
          assign result[i*M+:M] = 0;
          assign result_exponent[i*E+:E] = 0;
        end
      end
    end
  endgenerate
endmodule
