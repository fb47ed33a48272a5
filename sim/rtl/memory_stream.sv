// Words of the memory, one after the other from an address on: what reads records, splats to be sorted, lists and
// harmonics.
//
// A word is asked for only if the queue behind has a place, so that the memory never has to wait for whoever takes the
// words. `begins` starts anew once all words of the run before have been asked for.
module memory_stream #(
    parameter BITS = 128,
    parameter PLACES = 128
) (
    input logic clk,
    input logic rst,
    input logic begins,
    input logic [31:0] first,
    input logic [31:0] count,
    input logic none,  // `count` is 0, which is known before its sum is
    output logic read_valid,
    input logic read_ready,
    output logic [31:0] read_address,
    output logic requested,  // are all words of the run?
    input logic word_valid,
    input logic [BITS-1:0] word,
    output logic out_valid,
    input logic out_ready,
    output logic [BITS-1:0] out
);
  logic [31:0] left;
  logic free;

  // Known before the cycle in which it is asked: who reads next hangs on it, across the chip.
  assign read_valid = !requested && free;
  always_ff @(posedge clk) begin
    if (begins) begin
      left <= count;
      requested <= none;
      read_address <= first;
    end else if (read_valid && read_ready) begin
      left <= left - 1'b1;
      requested <= left == 1;
      read_address <= read_address + 1'b1;
    end
    if (rst) begin
      left <= 0;
      requested <= 1;
    end
  end

  fifo #(
      .BITS(BITS),
      .PLACES(PLACES)
  ) queue (
      .clk,
      .rst,
      .claim(read_valid && read_ready),
      .free,
      .none(),
      .in_valid(word_valid),
      .in(word),
      .out_valid,
      .out_ready,
      .out,
      .next()
  );
endmodule
