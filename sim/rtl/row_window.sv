// A row's span cut to the window: from where it begins and ends (any number of columns away) to the run's first column and length.
//
// Whatever the arithmetic before it gives, no run leaves this unit that has a pixel outside the window or no pixel at all
// (proven, `formal/row_window_properties.svh`). The window must lie within one block of columns.
//
//   17 within the box | 18 within the block and the window | 19 order, length, part left of the window | 20 what is left
module row_window (
    input logic clk,
    // In stage 16: the span, and the columns of the box and of its part in the window, of which there is one at least.
    input logic signed [32:0] low,
    input logic signed [32:0] high,
    input logic [15:0] box_first,
    input logic [15:0] box_end,
    input logic [15:0] first_column,
    input logic [15:0] end_column,
    output logic [15:0] x18,  // where the block's part of the span begins: the place of the seed
    output logic holds19,  // is there a pixel?
    output logic [4:0] head20,  // pixels between seed and run
    output logic [splatline_pkg::TILE_COLUMN_BITS-1:0] column20,
    output logic [splatline_pkg::TILE_COLUMN_BITS:0] count20
);
  localparam BLOCK_BITS = splatline_pkg::BLOCK_BITS;
  localparam COLUMN_BITS = splatline_pkg::TILE_COLUMN_BITS;

  function automatic logic [15:0] clamp(input logic signed [32:0] value, input logic [15:0] first, input logic [15:0] beyond);
    // Numbers of columns have 16 bits: what lies above these decides beside the comparison, not in it.
    if (value[32] || (value[31:16] == 0 && value[15:0] < first)) clamp = first;
    else if (value[31:16] != 0 || value[15:0] > beyond) clamp = beyond;
    else clamp = value[15:0];
  endfunction

  logic [15:0] low17, high17, first_column17, end_column17, first_column18, block17, end18, length19, head19;
  logic [COLUMN_BITS-1:0] x19;
  logic order19, fits19;
  assign block17 = {first_column17[15:BLOCK_BITS], BLOCK_BITS'(0)};
  assign fits19 = head19 < length19;
  assign holds19 = order19 && fits19;
  always_ff @(posedge clk) begin
    low17 <= clamp(low, box_first, box_end);
    high17 <= clamp(high, box_first, box_end);
    first_column17 <= first_column;
    end_column17 <= end_column;
    x18 <= low17 > block17 ? low17 : block17;
    end18 <= high17 < end_column17 ? high17 : end_column17;
    first_column18 <= first_column17;
    order19 <= x18 < end18;
    length19 <= end18 - x18;
    head19 <= x18 < first_column18 ? first_column18 - x18 : 16'd0;
    x19 <= x18[COLUMN_BITS-1:0];
    head20 <= head19[4:0];
    count20 <= length19[COLUMN_BITS:0] - head19[COLUMN_BITS:0];
    column20 <= x19 + head19[COLUMN_BITS-1:0];
  end

`ifdef FORMAL
`include "formal/row_window_properties.svh"
`endif
endmodule
