// multiply.sv, three cycles; see turn.sv.
module shared_multiply #(
    parameter LEFT = 18,
    parameter RIGHT = 18,
    parameter INTERVAL = 4,
    parameter [3:0] USED = 4'b1111
) (
    input logic clk,
    input logic [1:0] phase,
    input logic [4*LEFT-1:0] left,
    input logic [4*RIGHT-1:0] right,
    output logic [4*(LEFT+RIGHT)-1:0] product
);
  localparam BITS = LEFT + RIGHT;
  localparam UNITS = INTERVAL == 4 ? 1 : 4;
  logic [UNITS*LEFT-1:0] lefts;
  logic [UNITS*RIGHT-1:0] rights;
  turn #(.BITS(LEFT), .INTERVAL(INTERVAL)) turn_left (.clk, .phase, .in(left), .out(lefts));
  turn #(.BITS(RIGHT), .INTERVAL(INTERVAL)) turn_right (.clk, .phase, .in(right), .out(rights));
  genvar i;
  generate
    if (INTERVAL == 4) begin : gen_one
      logic [BITS-1:0] only;
      multiply #(.LEFT(LEFT), .RIGHT(RIGHT)) unit (.clk, .advance(1'b1), .left(lefts), .right(rights), .low(), .product(only));
      assign product = {4{only}};
    end else begin : gen_all
      for (i = 0; i < 4; i = i + 1) begin : gen_stage
        if (USED[i]) begin : gen_used
          multiply #(.LEFT(LEFT), .RIGHT(RIGHT)) unit (.clk, .advance(1'b1), .left(lefts[i*LEFT+:LEFT]), .right(rights[i*RIGHT+:RIGHT]), .low(), .product(product[i*BITS+:BITS]));
        end else begin : gen_unused
          assign product[i*BITS+:BITS] = 0;
        end
      end
    end
  endgenerate
endmodule
