// multiply.sv, three cycles. USED names the places that there are; see turn.sv.
module shared_multiply #(
    parameter LEFT = 18,
    parameter RIGHT = 18,
    parameter INTERVAL = 4,
    parameter [7:0] USED = 8'hff
) (
    input logic clk,
    input logic [2:0] phase,
    input logic [8*LEFT-1:0] left,
    input logic [8*RIGHT-1:0] right,
    output logic [8*(LEFT+RIGHT)-1:0] product
);
  localparam BITS = LEFT + RIGHT;
  localparam UNITS = 8 / INTERVAL;
  logic [UNITS*LEFT-1:0] lefts;
  logic [UNITS*RIGHT-1:0] rights;
  turn #(.BITS(LEFT), .INTERVAL(INTERVAL)) turn_left (.clk, .phase, .in(left), .out(lefts));
  turn #(.BITS(RIGHT), .INTERVAL(INTERVAL)) turn_right (.clk, .phase, .in(right), .out(rights));
  genvar i;
  generate
    for (i = 0; i < UNITS; i = i + 1) begin : gen_unit
      logic [BITS-1:0] only;
      if (USED[i*INTERVAL+:INTERVAL] != 0) begin : gen_used
        multiply #(.LEFT(LEFT), .RIGHT(RIGHT)) unit (.clk, .advance(1'b1), .left(lefts[i*LEFT+:LEFT]), .right(rights[i*RIGHT+:RIGHT]), .low(), .product(only));
      end else begin : gen_unused
        assign only = 0;
      end
      assign product[i*INTERVAL*BITS+:INTERVAL*BITS] = {INTERVAL{only}};
    end
  endgenerate
endmodule
