// align.sv, five cycles. USED names the places that there are; see turn.sv.
module shared_align #(
    parameter BITS = 36,
    parameter INTERVAL = 4,
    parameter [7:0] USED = 8'hff
) (
    input logic clk,
    input logic [2:0] phase,
    input logic [7:0] negative,
    input logic [8*BITS-1:0] magnitude,
    input logic [8*splatline_pkg::EXPONENT-1:0] shift,
    output logic [511:0] result
);
  localparam E = splatline_pkg::EXPONENT;
  localparam UNITS = 8 / INTERVAL;
  logic [UNITS-1:0] negatives;
  logic [UNITS*BITS-1:0] magnitudes;
  logic [UNITS*E-1:0] shifts;
  turn #(.BITS(1), .INTERVAL(INTERVAL)) turn_negative (.clk, .phase, .in(negative), .out(negatives));
  turn #(.BITS(BITS), .INTERVAL(INTERVAL)) turn_magnitude (.clk, .phase, .in(magnitude), .out(magnitudes));
  turn #(.BITS(E), .INTERVAL(INTERVAL)) turn_shift (.clk, .phase, .in(shift), .out(shifts));
  genvar i;
  generate
    for (i = 0; i < UNITS; i = i + 1) begin : gen_unit
      logic [63:0] only;
      if (USED[i*INTERVAL+:INTERVAL] != 0) begin : gen_used
        align #(.BITS(BITS), .SHIFT(E)) unit (.clk, .negative(negatives[i]), .magnitude(magnitudes[i*BITS+:BITS]), .shift(shifts[i*E+:E]), .result(only));
      end else begin : gen_unused
        assign only = 0;
      end
      assign result[i*INTERVAL*64+:INTERVAL*64] = {INTERVAL{only}};
    end
  endgenerate
endmodule
