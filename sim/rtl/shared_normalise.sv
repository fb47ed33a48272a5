// normalise.sv, four cycles. USED names the places that there are; see turn.sv.
module shared_normalise #(
    parameter BITS = 41,
    parameter INTERVAL = 4,
    parameter [7:0] USED = 8'hff
) (
    input logic clk,
    input logic [2:0] phase,
    input logic [7:0] negative,
    input logic [8*BITS-1:0] magnitude,
    input logic [8*splatline_pkg::EXPONENT-1:0] exponent,
    output logic [7:0] result_negative,
    output logic [8*splatline_pkg::MANTISSA-1:0] result,
    output logic [8*splatline_pkg::EXPONENT-1:0] result_exponent
);
  localparam M = splatline_pkg::MANTISSA;
  localparam E = splatline_pkg::EXPONENT;
  localparam UNITS = 8 / INTERVAL;
  logic [UNITS-1:0] negatives;
  logic [UNITS*BITS-1:0] magnitudes;
  logic [UNITS*E-1:0] exponents;
  turn #(.BITS(1), .INTERVAL(INTERVAL)) turn_negative (.clk, .phase, .in(negative), .out(negatives));
  turn #(.BITS(BITS), .INTERVAL(INTERVAL)) turn_magnitude (.clk, .phase, .in(magnitude), .out(magnitudes));
  turn #(.BITS(E), .INTERVAL(INTERVAL)) turn_exponent (.clk, .phase, .in(exponent), .out(exponents));
  genvar i;
  generate
    for (i = 0; i < UNITS; i = i + 1) begin : gen_unit
      logic only_negative;
      logic [M-1:0] only;
      logic [E-1:0] only_exponent;
      if (USED[i*INTERVAL+:INTERVAL] != 0) begin : gen_used
        normalise #(.BITS(BITS)) unit (.clk, .negative(negatives[i]), .magnitude(magnitudes[i*BITS+:BITS]), .exponent(exponents[i*E+:E]), .result_negative(only_negative), .result(only), .result_exponent(only_exponent));
      end else begin : gen_unused
        assign {only_negative, only, only_exponent} = 0;
      end
      assign result_negative[i*INTERVAL+:INTERVAL] = {INTERVAL{only_negative}};
      assign result[i*INTERVAL*M+:INTERVAL*M] = {INTERVAL{only}};
      assign result_exponent[i*INTERVAL*E+:INTERVAL*E] = {INTERVAL{only_exponent}};
    end
  endgenerate
endmodule
