// A queue of runs before a lane, so that lanes with long rows and lanes with short ones need not wait for each other.
// The lane sees a register, not the memory: a run can be taken two cycles after it came.
//
// Runs are numbered as they come, modulo SLOTS: by its number the lane's pipeline finds what it needs of a run later
// (run_paint.sv).
module run_queue #(
    parameter DEPTH = 8,
    parameter SLOTS = 16
) (
    input logic clk,
    input logic rst,
    input logic in_valid,
    output logic in_ready,
    output logic ready_next,  // `in_ready` of the next cycle
    input splatline_pkg::run_t in_run,
    output logic [$clog2(SLOTS)-1:0] in_slot,
    output logic out_valid,
    input logic out_ready,
    output splatline_pkg::run_t out_run,
    output logic [$clog2(SLOTS)-1:0] out_slot,
    output logic empty
);
  localparam BITS = $clog2(DEPTH);

  logic [$bits(in_run)-1:0] memory[0:DEPTH-1];
  logic [$clog2(SLOTS)-1:0] head, tail;
  logic [BITS:0] count;
  // Whether there are any, and whether there is no place, have registers of their own: both lie on long ways.
  logic some, full, put, moves;

  assign in_ready = !full;
  assign ready_next = rst || moves || !(full || (put && count == (BITS + 1)'(DEPTH - 1)));
  assign in_slot = tail;
  assign put = in_valid && !full;
  assign moves = some && (!out_valid || out_ready);
  assign empty = !some && !out_valid;

  always_ff @(posedge clk) begin
    if (put) memory[tail[BITS-1:0]] <= in_run;
    if (moves) begin
      out_run <= memory[head[BITS-1:0]];
      out_slot <= head;
    end
    if (rst) begin
      head <= 0;
      tail <= 0;
      count <= 0;
      some <= 0;
      full <= 0;
      out_valid <= 0;
    end else begin
      if (put) tail <= tail + 1'b1;
      if (moves) head <= head + 1'b1;
      out_valid <= moves || (out_valid && !out_ready);
      count <= count + {{BITS{1'b0}}, put} - {{BITS{1'b0}}, moves};
      some <= put || (some && !(moves && count == (BITS + 1)'(1)));
      full <= !ready_next;
    end
  end

`ifdef FORMAL
`include "formal/run_queue_properties.svh"
`endif
endmodule
