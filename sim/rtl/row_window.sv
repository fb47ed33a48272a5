// A row's span cut to the window: from where it begins and ends (any number of columns away) to the run's first column
// and length.
//
// Whatever the arithmetic before it gives, no run leaves this unit that has a pixel outside the window or no pixel at
// all (proven, `formal/row_window_properties.svh`). The window must lie within one block of columns, and of what lies
// in a block the column's lowest bits say all: whole columns are compared only where the span comes from afar.
//
//   18 within the window | 19 | 20 order, length
module row_window (
    input logic clk,
    // In stage 17: the span, and the columns of the box in the window, of which there is one at least.
    input logic signed [32:0] low,
    input logic signed [32:0] high,
    input logic [15:0] start_column,
    input logic [15:0] end_column,
    output logic [15:0] x19,  // where the span begins: the place of the seed
    output logic holds20,  // is there a pixel?
    output logic [splatline_pkg::TILE_COLUMN_BITS-1:0] column20,
    output logic [splatline_pkg::TILE_COLUMN_BITS:0] count20
);
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

  logic [15:0] x18, end18, end19;
  always_ff @(posedge clk) begin
    x18 <= not_before(low, start_column);
    end18 <= not_beyond(high, end_column);
    x19 <= x18;
    end19 <= end18;
    holds20 <= x19 < end19;
    column20 <= x19[COLUMN_BITS-1:0];
    count20 <= end19[COLUMN_BITS:0] - x19[COLUMN_BITS:0];
  end

`ifdef FORMAL
`include "formal/row_window_properties.svh"
`endif
endmodule
