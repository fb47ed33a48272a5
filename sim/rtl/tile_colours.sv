// A lane's colours in both buffers of a tile: the lane draws into the one, the scan reads the other. They are never
// cleared: a pixel whose transmittance is still 1 has no colour yet, whatever lies here of an older tile, so that who
// reads a colour looks at the transmittance. Both buffers have one write register.
//
// Where a block RAM at its full width has room for both buffers, there are two copies of both, one for the lane and
// one for the scan, in as many block RAMs as one copy of each takes apart. Then nothing stands between memory and
// reader, which saves a choice for each bit of address and word.
//
// A word comes two cycles after its address, as in tile_buffer.sv.
module tile_colours #(
    parameter BITS = 32,
    parameter ADDRESS = 10,
    parameter BLOCK_WORDS = 512  // of a block RAM at its full width
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
  logic writes;
  logic [ADDRESS:0] address;
  logic [BITS-1:0] word;
  always_ff @(posedge clk)
    if (advance) begin
      writes <= write;
      address <= {drawn, write_address};
      word <= write_word;
    end

  genvar b;
  generate
    if ((2 << ADDRESS) <= BLOCK_WORDS) begin : gen_copies
      (* no_rw_check *) logic [BITS-1:0] drawn_words[0:(2<<ADDRESS)-1];
      (* no_rw_check *) logic [BITS-1:0] scan_words[0:(2<<ADDRESS)-1];
      logic [BITS-1:0] found, scan_found;
      always_ff @(posedge clk) begin
        if (writes) drawn_words[address] <= word;
        if (writes) scan_words[address] <= word;
        if (advance) begin
          found <= drawn_words[{drawn, read_address}];
          read_word <= found;
        end
        if (scan) begin
          scan_found <= scan_words[{!drawn, scan_address}];
          scan_word <= scan_found;
        end
      end
    end else begin : gen_banks
      logic [2*BITS-1:0] read_words;
      assign read_word = drawn ? read_words[BITS+:BITS] : read_words[0+:BITS];
      assign scan_word = drawn ? read_words[0+:BITS] : read_words[BITS+:BITS];
      for (b = 0; b < 2; b = b + 1) begin : gen_side
        (* no_rw_check *) logic [BITS-1:0] words[0:(1<<ADDRESS)-1];
        logic [BITS-1:0] found;
        logic mine, moves;
        logic [ADDRESS-1:0] from;
        assign mine = drawn == b[0];
        assign moves = mine ? advance : scan;
        assign from = mine ? read_address : scan_address;
        always_ff @(posedge clk) begin
          if (writes && address[ADDRESS] == b[0]) words[address[ADDRESS-1:0]] <= word;
          if (moves) begin
            found <= words[from];
            read_words[b*BITS+:BITS] <= found;
          end
        end
      end
    end
  endgenerate
endmodule
