// One bank of the tile buffer: a memory with one read and one write port. A read in the cycle of a write to the same word gives the
// old value; the blend unit keeps what it wrote last.
module tile_buffer #(
    parameter BITS = 32,
    parameter ADDRESS = 10
) (
    input logic clk,
    input logic advance,
    input logic write,
    input logic [ADDRESS-1:0] write_address,
    input logic [BITS-1:0] write_word,
    input logic [ADDRESS-1:0] read_address,
    output logic [BITS-1:0] read_word
);
  logic [BITS-1:0] words[0:(1<<ADDRESS)-1];

  always_ff @(posedge clk) begin
    if (write) words[write_address] <= write_word;
    if (advance) read_word <= words[read_address];
  end
endmodule
