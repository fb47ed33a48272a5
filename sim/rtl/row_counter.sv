// The rows of one splat after the other, one for each `issue`; a splat without rows issues one that is none (`some` is
// not set).
//
// Every row of a splat is issued once, in order, and no other (proven, `formal/row_counter_properties.svh`).
module row_counter (
    input logic clk,
    input logic rst,
    input logic splat_valid,
    output logic splat_ready,
    // The splat's first row within the tile and how many it has.
    input logic [splatline_pkg::TILE_ROW_BITS-1:0] first,
    input logic [splatline_pkg::TILE_ROW_BITS:0] rows,
    input logic place,  // for a row
    output logic busy,
    output logic issue,
    output logic [splatline_pkg::TILE_ROW_BITS-1:0] row,
    output logic some
);
  localparam COUNT = splatline_pkg::TILE_ROW_BITS + 1;
  logic last;
  logic [COUNT-1:0] left;
  assign issue = busy && place;
  assign splat_ready = !busy || (issue && last);
  assign some = left != 0;
  always_ff @(posedge clk) begin
    if (rst) busy <= 0;
    else if (splat_ready) busy <= splat_valid;
    if (splat_ready) begin
      row <= first;
      left <= rows;
      last <= rows <= COUNT'(1);
    end else if (issue) begin
      row <= row + 1'b1;
      left <= left - 1'b1;
      last <= left == COUNT'(2);
    end
  end

`ifdef FORMAL
`include "formal/row_counter_properties.svh"
`endif
endmodule
