// Entries of the lists to packets: the numbers in the words of the lists, and the words of the packets that they name,
// in their order.
//
// Lists of all tiles follow each other in memory and tiles are drawn in that order, so that packets run ahead across
// the ends of tiles, as many as the queue has places for.
module packet_fetch #(
    parameter WORDS = 4,  // of a packet
    parameter PLACES = 256
) (
    input logic clk,
    input logic rst,
    input logic begins,
    input logic [31:0] base,
    input logic [31:0] entries,
    input logic list_valid,
    output logic list_ready,
    input logic [127:0] list,
    output logic read_valid,
    input logic read_ready,
    output logic [31:0] read_address,
    input logic word_valid,
    input logic [127:0] word,
    output logic packet_next,  // one is there in the next cycle
    input logic packet_ready,
    output logic [128*WORDS-1:0] packet  // a whole one waits while the next is gathered
);
  localparam INDEX = $clog2(WORDS);
  logic [31:0] left;
  logic more;  // are there entries left?
  logic [1:0] entry;
  logic [INDEX-1:0] step, gathered;
  logic free, last, goes, takes, pending, word_out_valid, word_out_ready;
  logic [127:0] word_out, numbers;

  // An entry's address is some sums, for which it has a cycle of its own, while the packet before is still asked for.
  assign last = step == INDEX'(WORDS - 1);
  assign read_valid = pending && free;
  assign goes = read_valid && read_ready;
  assign takes = !list_ready && more && (!pending || (goes && last));

  always_ff @(posedge clk) begin
    // A word of the lists is used up with its last entry. The next one comes while the packet of that entry is asked
    // for, so that nothing before it hangs on who takes it.
    if (list_ready) begin
      numbers <= list;
      list_ready <= !list_valid;
    end
    if (goes) begin
      step <= last ? '0 : step + 1'b1;
      read_address <= read_address + 1'b1;
      if (last) pending <= 0;
    end
    if (takes) begin
      pending <= 1;
      read_address <= base + splatline_math::times(numbers[32*entry+:32], 4'(WORDS));
      entry <= entry + 1'b1;
      list_ready <= entry == 2'd3;
      left <= left - 1'b1;
      more <= left != 1;
    end
    if (begins) begin
      left <= entries;
      more <= entries != 0;
      {entry, step} <= 0;
      list_ready <= 1;
    end
    if (rst) {more, pending} <= 0;
  end

  fifo #(
      .BITS(128),
      .PLACES(PLACES)
  ) queue (
      .clk,
      .rst,
      .claim(goes),
      .free,
      .none(),
      .in_valid(word_valid),
      .in(word),
      .out_valid(word_out_valid),
      .out_ready(word_out_ready),
      .out(word_out),
      .next()
  );

  logic [128*(WORDS-1)-1:0] held;
  logic packet_valid, whole, moves;
  assign whole = gathered == INDEX'(WORDS - 1);
  // A packet's place is free for a cycle before the next one comes, which takes as long anyway: so nothing before it
  // hangs on who takes it.
  assign moves = !packet_valid;
  assign packet_next = !rst && (moves ? word_out_valid && whole : !packet_ready);
  assign word_out_ready = !whole || moves;
  always_ff @(posedge clk) begin
    packet_valid <= packet_next;
    if (moves) packet <= {word_out, held};
    if (word_out_valid && word_out_ready) begin
      gathered <= whole ? '0 : gathered + 1'b1;
      held <= {word_out, held[128*(WORDS-1)-1:128]};
    end
    if (rst) gathered <= 0;
  end
endmodule
