// Two words between a unit and the memory's port: whether one is taken reaches nobody who gives one in the same cycle.
//
// A word comes out in the cycle after it went in at the earliest, as from a register.
module register_slice #(
    parameter BITS = 8
) (
    input logic clk,
    input logic rst,
    input logic in_valid,
    output logic in_ready,
    output logic ready_next,  // `in_ready` of the next cycle
    input logic [BITS-1:0] in,
    output logic out_valid,
    input logic out_ready,
    output logic [BITS-1:0] out
);
  (* ram_style = "distributed" *) logic [BITS-1:0] words[0:1];
  logic head, tail, full, put, leaves;

  assign in_ready = !full;
  assign ready_next = rst || leaves || !(full || (put && out_valid));
  assign put = in_valid && !full;
  assign leaves = out_valid && out_ready;
  assign out = words[head];
  always_ff @(posedge clk) begin
    // Whatever is there, while there is a place: whether it is a word is known late, and would have to reach all bits.
    if (!full) words[tail] <= in;
    full <= !ready_next;
    if (rst) begin
      head <= 0;
      tail <= 0;
      out_valid <= 0;
    end else begin
      head <= head ^ leaves;
      tail <= tail ^ put;
      out_valid <= put || full || (out_valid && !out_ready);
    end
  end
endmodule
