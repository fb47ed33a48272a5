// A footprint's box cut to the window: its first visible row and how many there are, and its columns there.
//
// Rows are counted within the tile, of which the window is a part. Whatever box comes, the rows that leave this unit
// lie in the window, and where there is one, the columns do and there is one of them at least, which is what
// row_window.sv is promised (proven, `formal/visible_box_properties.svh`).
//
//   2 what is visible | 3 how many rows: none, if the window holds none of the box's columns
module visible_box #(
    parameter ROW_BITS = splatline_pkg::TILE_ROW_BITS
) (
    input logic clk,
    input splatline_pkg::window_t window,
    // In stage 1: the box.
    input logic [15:0] first_row1,
    input logic [15:0] end_row1,
    input logic [15:0] box_first1,
    input logic [15:0] box_end1,
    output logic [ROW_BITS-1:0] row3,
    output logic [ROW_BITS:0] rows3,
    output logic [15:0] start_column3,
    output logic [15:0] end_column3
);
  logic [15:0] row2, end_row2, start_column2, end_column2;
  always_ff @(posedge clk) begin
    row2 <= first_row1 > window.first_row ? first_row1 : window.first_row;
    end_row2 <= end_row1 < window.end_row ? end_row1 : window.end_row;
    start_column2 <= box_first1 > window.first_column ? box_first1 : window.first_column;
    end_column2 <= box_end1 < window.end_column ? box_end1 : window.end_column;

    row3 <= row2[ROW_BITS-1:0];
    rows3 <= start_column2 < end_column2 && row2 < end_row2 ? end_row2[ROW_BITS:0] - row2[ROW_BITS:0] : '0;
    start_column3 <= start_column2;
    end_column3 <= end_column2;
  end

`ifdef FORMAL
`include "formal/visible_box_properties.svh"
`endif
endmodule
