// align.sv, five cycles. USED names the stages that there are; see turn.sv.
module shared_align #(
    parameter BITS = 36,
    parameter INTERVAL = 4,
    parameter [3:0] USED = 4'b1111
) (
    input logic clk,
    input logic [1:0] phase,
    input logic [3:0] negative,
    input logic [4*BITS-1:0] magnitude,
    input logic [4*splatline_pkg::EXPONENT-1:0] shift,
    output logic [255:0] result
);
  localparam E = splatline_pkg::EXPONENT;
  localparam UNITS = INTERVAL == 4 ? 1 : 4;
  logic [UNITS-1:0] negatives;
  logic [UNITS*BITS-1:0] magnitudes;
  logic [UNITS*E-1:0] shifts;
  turn #(.BITS(1), .INTERVAL(INTERVAL)) turn_negative (.clk, .phase, .in(negative), .out(negatives));
  turn #(.BITS(BITS), .INTERVAL(INTERVAL)) turn_magnitude (.clk, .phase, .in(magnitude), .out(magnitudes));
  turn #(.BITS(E), .INTERVAL(INTERVAL)) turn_shift (.clk, .phase, .in(shift), .out(shifts));
  genvar i;
  generate
    if (INTERVAL == 4) begin : gen_one
      logic [63:0] only;
      align #(.BITS(BITS), .SHIFT(E)) unit (.clk, .negative(negatives), .magnitude(magnitudes), .shift(shifts), .result(only));
      assign result = {4{only}};
    end else begin : gen_all
      for (i = 0; i < 4; i = i + 1) begin : gen_stage
        if (USED[i]) begin : gen_used
          align #(.BITS(BITS), .SHIFT(E)) unit (.clk, .negative(negatives[i]), .magnitude(magnitudes[i*BITS+:BITS]), .shift(shifts[i*E+:E]), .result(result[i*64+:64]));
        end else begin : gen_unused
          assign result[i*64+:64] = 0;
        end
      end
    end
  endgenerate
endmodule
