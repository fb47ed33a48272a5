// The next tile that has splats, or with EMPTY the next that has none: what hands tiles to the primitive, and what
// writes the background of the others.
//
// Lists follow each other without a gap, tile by tile, so that a tile whose list ends where that of the tile before
// does is empty. Ends are looked up one by one, in four cycles a tile: `request` holds `tile` out, the end comes two
// cycles after `granted`, and is judged in the next, when the list's length is in a register.
//
// Pixels of a tile begin behind those of all tiles before it. All but the last row of tiles have the same height, and
// all but the last column the same width, so that this place needs shifts and a sum alone, however many tiles are
// passed over.
module tile_finder #(
    parameter EMPTY = 0,
    parameter TILE_BITS = 12,
    parameter COUNT_BITS = 24
) (
    input logic clk,
    input logic rst,
    input logic begins,  // a picture: from its first tile on
    input logic [15:0] columns,
    input logic [15:0] rows,
    input logic [TILE_BITS:0] tiles,
    output logic request,
    input logic granted,
    input logic [COUNT_BITS-1:0] end_place,
    output logic [TILE_BITS:0] tile,  // all before it have been passed; `tiles` when there are no more
    output logic valid,
    input logic ready,
    output splatline_pkg::window_t window,
    output logic [31:0] first,  // pixels of the tiles before it
    output logic [COUNT_BITS-1:0] entries
);
  localparam COLUMN_BITS = splatline_pkg::TILE_COLUMN_BITS;
  localparam ROW_BITS = splatline_pkg::TILE_ROW_BITS;

  typedef enum logic [2:0] {
    REQUEST,
    READ,
    RESPONSE,
    JUDGE,
    FOUND,
    DONE
  } state_t;
  state_t state;
  logic [11:0] column, row;
  logic [31:0] row_first;
  logic [COUNT_BITS-1:0] begun;
  logic passes, last_in_row;

  function automatic logic [15:0] edge_of(input logic [11:0] number, input int bits, input logic [15:0] limit);
    logic [27:0] place;
    place = 28'({16'd0, number} + 28'd1) << bits;
    edge_of = place > 28'(limit) ? limit : place[15:0];
  endfunction
  // A tile is asked for before it is found: its window is there a cycle behind its number, with nothing but sums after
  // it.
  always_ff @(posedge clk) begin
    window.first_column <= 16'(column) << COLUMN_BITS;
    window.first_row <= 16'(row) << ROW_BITS;
    window.end_column <= edge_of(column, COLUMN_BITS, columns);
    window.end_row <= edge_of(row, ROW_BITS, rows);
  end
  assign last_in_row = window.end_column == columns;
  assign request = state == REQUEST;
  assign valid = state == FOUND;
  assign passes = (state == JUDGE && (entries == 0) != (EMPTY != 0)) || (valid && ready);

  always_ff @(posedge clk) begin
    if (request && granted) state <= READ;
    if (state == READ) state <= RESPONSE;
    if (state == RESPONSE) begin
      state <= JUDGE;
      entries <= end_place - begun;
      begun <= end_place;
    end
    if (state == JUDGE) state <= FOUND;
    if (passes) begin
      state <= tile + 1'b1 == tiles ? DONE : REQUEST;
      tile <= tile + 1'b1;
      column <= column + 1'b1;
      first <= first + ({16'd0, window.end_row - window.first_row} << COLUMN_BITS);
      if (last_in_row) begin
        column <= 0;
        row <= row + 1'b1;
        first <= row_first + (32'(columns) << ROW_BITS);
        row_first <= row_first + (32'(columns) << ROW_BITS);
      end
    end
    if (begins) begin
      state <= tiles == 0 ? DONE : REQUEST;
      {tile, column, row, first, row_first, begun} <= 0;
    end
    if (rst) state <= DONE;
  end
endmodule
