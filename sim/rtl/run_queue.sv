// A queue of runs before a lane, so that lanes with long rows and lanes with short ones need not wait for each other.
module run_queue #(
    parameter DEPTH = 8
) (
    input logic clk,
    input logic rst,
    input logic in_valid,
    output logic in_ready,
    input splatline_pkg::run_t in_run,
    output logic out_valid,
    input logic out_ready,
    output splatline_pkg::run_t out_run
);
  localparam BITS = $clog2(DEPTH);

  logic [$bits(in_run)-1:0] memory[0:DEPTH-1];
  logic [BITS-1:0] head, tail;
  logic [BITS:0] count;

  assign in_ready = count != DEPTH[BITS:0];
  assign out_valid = count != 0;
  assign out_run = memory[head];

  always_ff @(posedge clk) begin
    if (in_valid && in_ready) memory[tail] <= in_run;
    if (rst) begin
      head <= 0;
      tail <= 0;
      count <= 0;
    end else begin
      if (in_valid && in_ready) tail <= tail + 1'b1;
      if (out_valid && out_ready) head <= head + 1'b1;
      count <= count + {{BITS{1'b0}}, in_valid && in_ready} - {{BITS{1'b0}}, out_valid && out_ready};
    end
  end
endmodule
