// One bank of transmittances: a memory with one read and one write port, and the write port's registers. A lane has
// two, one that is drawn into while the other is read out. The read-out clears behind itself, so that a bank is clear
// whenever a tile begins; then nobody looks at colours (tile_colours.sv).
//
// A word comes two cycles after its address: block RAM is slow, so that its word goes into a register before anything
// chooses between two buffers.
//
// The word to be written has its register here, so that clearing is that register's reset and costs no gate for each
// bit. What a read in the cycle of a write to the same word gives is left open: the lane holds a pixel back until its
// last value is written, the read-out clears a cycle after it has read, and memories that promise more cost a register
// and a gate for each bit.
module tile_buffer #(
    parameter BITS = 32,
    parameter ADDRESS = 10,
    parameter [BITS-1:0] CLEAR = 0
) (
    input logic clk,
    input logic clears,  // the bank belongs to the scan, otherwise to its lane
    input logic clear,
    input logic [ADDRESS-1:0] clear_address,
    input logic advance,  // the lane moves
    input logic write,
    input logic [ADDRESS-1:0] write_address,
    input logic [BITS-1:0] write_word,
    input logic read,
    input logic [ADDRESS-1:0] read_address,
    output logic [BITS-1:0] read_word
);
  (* no_rw_check *) logic [BITS-1:0] words[0:(1<<ADDRESS)-1];
  logic writes;
  logic [ADDRESS-1:0] address;
  logic [BITS-1:0] word, found;

  always_ff @(posedge clk) begin
    if (clears) begin
      writes <= clear;
      word <= CLEAR;
    end else if (advance) begin
      writes <= write;
      word <= write_word;
    end
    if (clears || advance) address <= clears ? clear_address : write_address;
    if (writes) words[address] <= word;
    if (read) begin
      found <= words[read_address];
      read_word <= found;
    end
  end
endmodule
