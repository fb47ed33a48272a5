// A queue in block RAM behind a pipeline that never stands still: whoever feeds it counts its places (`free`) and lets
// no more in than there are, so that nothing has to be stopped half way.
//
// An entry comes out three cycles after it went in at the earliest: written, read, registered. A place is taken by
// `claim`, when something enters the pipeline before the queue, and given back when the entry leaves the queue.
//
// A pipeline knows some parts of an entry long before the last. They need not wait in registers beside it: each part
// has a memory of its own, into which it goes as soon as it is there, all parts of all entries in the same order. The
// entry is in when its last part is, the one of the highest bits. ENDS says where parts end in `in`, 16 bits for each,
// the first part's lowest.
//
// Parts of SEEN lie in look-up tables, and `next` has what will be in `out` in the next cycle: whoever takes entries by
// what they say can decide a cycle before, into a register. Block RAM would show it too late.
//
// With RESTS, entries leave in every other cycle at most. Then no memory has to know within a cycle whether its entry
// is taken, which for the queue of splats reached the enables of some twenty block RAMs and was the circuit's longest
// path.
module fifo #(
    parameter BITS = 8,
    parameter PLACES = 32,
    parameter RESTS = 0,
    parameter PARTS = 1,
    parameter [16*PARTS-1:0] ENDS = 16'(BITS),
    parameter [PARTS-1:0] SEEN = 0
) (
    input logic clk,
    input logic rst,
    input logic claim,
    output logic free,
    output logic none,  // nothing in the queue or on its way to it
    input logic [PARTS-1:0] in_valid,
    input logic [BITS-1:0] in,
    output logic out_valid,
    input logic out_ready,
    output logic [BITS-1:0] out,
    output logic [BITS-1:0] next
);
  localparam INDEX = $clog2(PLACES);

  // Where each part's next word goes; an entry is there when its last part is.
  logic [PARTS*(INDEX+1)-1:0] tails;
  logic [INDEX:0] head, tail, claimed;
  logic word_valid, word_moves, out_moves, leaves;

  assign tail = tails[(PARTS-1)*(INDEX+1)+:INDEX+1];
  assign out_moves = !out_valid || (out_ready && RESTS == 0);
  assign word_moves = !word_valid || out_moves;
  assign leaves = out_valid && out_ready;
  assign none = claimed == 0;

  genvar p;
  generate
    for (p = 0; p < PARTS; p = p + 1) begin : gen_part
      localparam END = ENDS[16*p+:16];
      localparam FIRST = p == 0 ? 0 : ENDS[16*(p==0?0:p-1)+:16];
      logic [END-FIRST-1:0] word;
      logic [INDEX:0] place;
      assign place = tails[p*(INDEX+1)+:INDEX+1];
      // A word is never read in the cycle in which it is written (its place would be empty), so that no circuit has to
      // say what comes out then.
      if (SEEN[p]) begin : gen_tables
        (* no_rw_check *) logic [END-FIRST-1:0] memory[0:PLACES-1];
        always_ff @(posedge clk) begin
          if (in_valid[p]) memory[place[INDEX-1:0]] <= in[END-1:FIRST];
          if (word_moves) word <= memory[head[INDEX-1:0]];
        end
        assign next[END-1:FIRST] = out_moves ? word : out[END-1:FIRST];
      end else begin : gen_block
        (* ram_style = "block", no_rw_check *) logic [END-FIRST-1:0] memory[0:PLACES-1];
        always_ff @(posedge clk) begin
          if (in_valid[p]) memory[place[INDEX-1:0]] <= in[END-1:FIRST];
          if (word_moves) word <= memory[head[INDEX-1:0]];
        end
        assign next[END-1:FIRST] = '0;
      end
      always_ff @(posedge clk) begin
        if (out_moves) out[END-1:FIRST] <= word;
        if (rst) tails[p*(INDEX+1)+:INDEX+1] <= 0;
        else if (in_valid[p]) tails[p*(INDEX+1)+:INDEX+1] <= place + 1'b1;
      end
    end
  endgenerate

  always_ff @(posedge clk) begin
    if (rst) begin
      head <= 0;
      claimed <= 0;
      free <= 1;
      word_valid <= 0;
      out_valid <= 0;
    end else begin
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
