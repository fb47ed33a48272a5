// A queue in block RAM behind a pipeline that never stands still: whoever feeds it counts its places (`free`) and lets
// no more in than there are, so that nothing has to be stopped half way.
//
// An entry comes out three cycles after it went in at the earliest: written, read, registered. A place is taken by `claim`, when something
// enters the pipeline before the queue, and given back when the entry leaves the queue.
//
// With RESTS, entries leave in every other cycle at most. Then no memory has to know within a cycle whether its entry is taken, which for the queue of
// splats reached the enables of some twenty block RAMs and was the circuit's longest path.
module fifo #(
    parameter BITS = 8,
    parameter PLACES = 32,
    parameter RESTS = 0
) (
    input logic clk,
    input logic rst,
    input logic claim,
    output logic free,
    output logic none,  // nothing in the queue or on its way to it
    input logic in_valid,
    input logic [BITS-1:0] in,
    output logic out_valid,
    input logic out_ready,
    output logic [BITS-1:0] out
);
  localparam INDEX = $clog2(PLACES);

  // A word is never read in the cycle in which it is written (its place would be empty), so that no circuit has to say what comes out then.
  (* ram_style = "block", no_rw_check *) logic [BITS-1:0] memory[0:PLACES-1];
  logic [INDEX:0] head, tail, claimed;
  logic [BITS-1:0] word;
  logic word_valid, word_moves, out_moves, leaves;

  assign out_moves = !out_valid || (out_ready && RESTS == 0);
  assign word_moves = !word_valid || out_moves;
  assign leaves = out_valid && out_ready;
  assign none = claimed == 0;

  always_ff @(posedge clk) begin
    if (in_valid) memory[tail[INDEX-1:0]] <= in;
    if (word_moves) word <= memory[head[INDEX-1:0]];
    if (out_moves) out <= word;
    if (rst) begin
      head <= 0;
      tail <= 0;
      claimed <= 0;
      free <= 1;
      word_valid <= 0;
      out_valid <= 0;
    end else begin
      if (in_valid) tail <= tail + 1'b1;
      if (word_moves) begin
        word_valid <= head != tail;
        if (head != tail) head <= head + 1'b1;
      end
      if (out_moves) out_valid <= word_valid;
      else if (out_ready) out_valid <= 0;
      claimed <= claimed + {{INDEX{1'b0}}, claim} - {{INDEX{1'b0}}, leaves};
      // Is a place left after this cycle? Beside the count, not behind it.
      free <= leaves || !(claimed == PLACES[INDEX:0] || (claim && claimed == (INDEX + 1)'(PLACES - 1)));
    end
  end

`ifdef FORMAL
`include "formal/fifo_properties.svh"
`endif
endmodule
