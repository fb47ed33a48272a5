// A lane's colours in both buffers of a tile: one write register in front of both memories, one lane that draws into
// the one, one scan that reads the other. They are never cleared: a pixel whose transmittance is still 1 has no
// colour yet, whatever lies here of an older tile, and who reads a colour looks at the transmittance.
//
// A word comes two cycles after its address, as in tile_buffer.sv.
module tile_colours #(
    parameter BITS = 32,
    parameter ADDRESS = 10
) (
    input logic clk,
    input logic drawn,  // the buffer that the lane draws into
    input logic advance,  // the lane moves
    input logic write,
    input logic [ADDRESS-1:0] write_address,
    input logic [BITS-1:0] write_word,
    input logic [ADDRESS-1:0] read_address,
    output logic [BITS-1:0] read_word,
    input logic scan,  // the scan moves
    input logic [ADDRESS-1:0] scan_address,
    output logic [BITS-1:0] scan_word
);
  logic [1:0] writes;
  logic [ADDRESS-1:0] address;
  logic [BITS-1:0] word;
  logic [2*BITS-1:0] read_words;
  assign read_word = drawn ? read_words[BITS+:BITS] : read_words[0+:BITS];
  assign scan_word = drawn ? read_words[0+:BITS] : read_words[BITS+:BITS];

  always_ff @(posedge clk)
    if (advance) begin
      writes <= {write && drawn, write && !drawn};
      address <= write_address;
      word <= write_word;
    end

  genvar b;
  generate
    for (b = 0; b < 2; b = b + 1) begin : gen_side
      (* no_rw_check *) logic [BITS-1:0] words[0:(1<<ADDRESS)-1];
      logic [BITS-1:0] found;
      logic mine, moves;
      logic [ADDRESS-1:0] from;
      assign mine = drawn == b[0];
      assign moves = mine ? advance : scan;
      assign from = mine ? read_address : scan_address;
      always_ff @(posedge clk) begin
        if (writes[b]) words[address] <= word;
        if (moves) begin
          found <= words[from];
          read_words[b*BITS+:BITS] <= found;
        end
      end
    end
  endgenerate
endmodule
