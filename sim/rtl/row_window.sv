// A row's span cut to the window: from where it begins and ends (any number of columns away) to the run's first column and length.
//
// Whatever the arithmetic before it gives, no run leaves this unit that has a pixel outside the window or no pixel at
// all (proven, `formal/row_window_properties.svh`). The window must lie within one block of columns, and of what lies
// in a block the column's lowest bits say all: whole columns are compared only where the span comes from afar.
//
//   17 within the block and the window | 18 | 19 order, length, part left of the window | 20 what is left
module row_window (
    input logic clk,
    // In stage 16: the span, where the block's part of the box begins, and the columns of the box in the window, of
    // which there is one at least.
    input logic signed [32:0] low,
    input logic signed [32:0] high,
    input logic [15:0] start_column,
    input logic [splatline_pkg::BLOCK_BITS-1:0] first_column,  // within the block
    input logic [15:0] end_column,
    output logic [15:0] x18,  // where the block's part of the span begins: the place of the seed
    output logic holds19,  // is there a pixel?
    output logic [4:0] head20,  // pixels between seed and run
    output logic [splatline_pkg::TILE_COLUMN_BITS-1:0] column20,
    output logic [splatline_pkg::TILE_COLUMN_BITS:0] count20
);
  localparam BLOCK_BITS = splatline_pkg::BLOCK_BITS;
  localparam COLUMN_BITS = splatline_pkg::TILE_COLUMN_BITS;

  // Numbers of columns have 16 bits: what lies above these decides beside the comparison, not in it. A span that
  // begins right of the box ends in it at the latest, so that it has no pixel, and neither has one that ends left of
  // it.
  function automatic logic [15:0] not_before(input logic signed [32:0] value, input logic [15:0] first);
    if (value[32] || (value[31:16] == 0 && value[15:0] < first)) not_before = first;
    else not_before = value[15:0] | {16{value[31:16] != 0}};
  endfunction
  function automatic logic [15:0] not_beyond(input logic signed [32:0] value, input logic [15:0] beyond);
    if (!value[32] && (value[31:16] != 0 || value[15:0] > beyond)) not_beyond = beyond;
    else not_beyond = value[32] ? 16'd0 : value[15:0];
  endfunction

  logic [15:0] x17, end17, end18;
  logic [BLOCK_BITS-1:0] begins17, begins18, head19;
  logic [BLOCK_BITS:0] length19;
  logic [COLUMN_BITS-1:0] x19;
  logic order19, fits19;
  assign fits19 = {1'b0, head19} < length19;
  assign holds19 = order19 && fits19;
  always_ff @(posedge clk) begin
    x17 <= not_before(low, start_column);
    end17 <= not_beyond(high, end_column);
    begins17 <= first_column;
    x18 <= x17;
    end18 <= end17;
    begins18 <= begins17;
    order19 <= x18 < end18;
    length19 <= end18[BLOCK_BITS:0] - x18[BLOCK_BITS:0];
    head19 <= x18[BLOCK_BITS-1:0] < begins18 ? begins18 - x18[BLOCK_BITS-1:0] : '0;
    x19 <= x18[COLUMN_BITS-1:0];
    head20 <= 5'(head19);
    count20 <= length19[COLUMN_BITS:0] - (COLUMN_BITS + 1)'(head19);
    column20 <= x19 + head19[COLUMN_BITS-1:0];
  end

`ifdef FORMAL
`include "formal/row_window_properties.svh"
`endif
endmodule
