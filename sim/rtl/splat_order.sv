// Visible splats in, lists of every tile out: sorted by depth over memory, then binned.
//
//   splat -> depth_sort <-> memory_stream -> tile_binning -> lists
//        `-> tile_binning (counts)
//
// A splat is a word: the box of its tiles, its number, its key. Both units take it; when no more will come, it is
// sorted, and then listed.
module splat_order #(
    parameter DIGIT = 8,
    parameter TILE_BITS = 12,
    parameter COUNT_BITS = 24,
    parameter PLACES = 128
) (
    input logic clk,
    input logic rst,
    input logic begins,
    input logic [31:0] base_a,
    input logic [31:0] base_b,
    input logic [31:0] base_lists,
    input logic [11:0] tile_columns,
    input logic [TILE_BITS:0] tiles,
    input logic [COUNT_BITS-1:0] most,
    input logic in_valid,
    output logic in_ready,
    input logic [127:0] in,
    input logic ends,
    output logic read_valid,
    input logic read_ready,
    output logic [31:0] read_address,
    input logic word_valid,
    input logic [127:0] word,
    output logic write_valid,
    input logic write_ready,
    output logic [31:0] write_address,
    output logic [127:0] write_word,
    output logic [3:0] write_strobe,
    input logic settled,
    output logic done,
    output logic full,
    output logic [COUNT_BITS-1:0] splats,
    output logic [COUNT_BITS-1:0] entries,
    output logic [31:0] sorted,
    input logic [TILE_BITS-1:0] end_tile,
    output logic [COUNT_BITS-1:0] end_place
);
  logic sort_ready, box_ready, sort_done, counted, binned, listing, started, lists;
  logic sort_begins, sort_splat_ready, list_splat_ready;
  logic splat_valid;
  logic [127:0] splat;
  logic [31:0] sort_first, sort_count;
  logic sort_write, list_write;
  logic [31:0] sort_address, list_address, list_number;
  logic [127:0] sort_word;
  logic [3:0] list_strobe;

  assign in_ready = sort_ready && box_ready;

  depth_sort #(
      .DIGIT(DIGIT),
      .COUNT_BITS(COUNT_BITS)
  ) sorter (
      .clk,
      .rst,
      .begins,
      .base_a,
      .base_b,
      .in_valid(in_valid && box_ready),
      .in_ready(sort_ready),
      .in,
      .ends(ends && !in_valid),
      .stream_begins(sort_begins),
      .stream_first(sort_first),
      .stream_count(sort_count),
      .splat_valid(splat_valid && !listing),
      .splat_ready(sort_splat_ready),
      .splat,
      .write_valid(sort_write),
      .write_ready,
      .write_address(sort_address),
      .write_word(sort_word),
      .settled,
      .done(sort_done),
      .count(splats),
      .sorted
  );

  tile_binning #(
      .TILE_BITS(TILE_BITS),
      .COUNT_BITS(COUNT_BITS)
  ) binning (
      .clk,
      .rst,
      .begins,
      .base(base_lists),
      .tile_columns,
      .tiles,
      .most,
      .box_valid(in_valid && sort_ready),
      .box_ready,
      .box(in[127:80]),
      .ends(ends && !in_valid),
      .splats,
      .splat_valid(splat_valid && listing),
      .splat_ready(list_splat_ready),
      .splat(splat[127:48]),
      .write_valid(list_write),
      .write_ready,
      .write_address(list_address),
      .write_number(list_number),
      .write_strobe(list_strobe),
      .counted,
      .done(binned),
      .full,
      .entries,
      .end_tile,
      .end_place
  );

  // The sorter's passes, and then the lists'. Both units are done before their picture begins, too.
  assign lists = started && sort_done && counted && !listing;
  assign done = listing && sort_done && binned && settled;
  always_ff @(posedge clk) begin
    started <= !begins && started;
    if (begins) listing <= 0;
    else if (!started) started <= !sort_done && !binned;
    else if (lists) listing <= 1;
    if (rst) {started, listing} <= 0;
  end

  memory_stream #(
      .PLACES(PLACES)
  ) stream (
      .clk,
      .rst,
      .begins(sort_begins || lists),
      .first(sort_first),
      .count(sort_count),
      .none((lists && full) || sort_count == 0),
      .read_valid,
      .read_ready,
      .read_address,
      .requested(),
      .word_valid,
      .word,
      .out_valid(splat_valid),
      .out_ready(listing ? list_splat_ready : sort_splat_ready),
      .out(splat)
  );

  assign write_valid = sort_write || list_write;
  assign write_address = list_write ? list_address : sort_address;
  assign write_word = list_write ? {4{list_number}} : sort_word;
  assign write_strobe = list_write ? list_strobe : 4'hf;
endmodule
