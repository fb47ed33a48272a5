// Pixels of the tiles that have no splats, tile by tile: where in the frame the next one belongs. All are the same
// word.
//
// The primitive never sees such a tile, since reading one out would keep it for a cycle a pixel. Whoever takes these
// pixels takes them when he has nothing else to do; nobody waits for them. Tiles keep their turn: those up to the tile
// that is drawn, as in the model (`RasterUnit::write_background`).
module tile_background #(
    parameter TILE_BITS = 12,
    parameter COUNT_BITS = 24
) (
    input logic clk,
    input logic rst,
    input logic begins,
    input logic [15:0] columns,
    input logic [15:0] rows,
    input logic [TILE_BITS:0] tiles,
    input logic [TILE_BITS:0] turn,  // tiles before this one may be written
    input logic granted,
    output logic [TILE_BITS-1:0] end_tile,
    input logic [COUNT_BITS-1:0] end_place,
    output logic pixel_valid,
    input logic pixel_ready,
    output logic [31:0] place
);
  localparam COLUMN_BITS = splatline_pkg::TILE_COLUMN_BITS;
  localparam ROW_BITS = splatline_pkg::TILE_ROW_BITS;

  logic found, may_be_written, last_pixel;
  logic [TILE_BITS:0] tile;
  logic [31:0] first;
  splatline_pkg::window_t window;
  logic [COLUMN_BITS:0] width;
  logic [ROW_BITS:0] height;
  logic [COLUMN_BITS+ROW_BITS-1:0] pixel, pixels, last;
  tile_finder #(
      .EMPTY(1),
      .TILE_BITS(TILE_BITS),
      .COUNT_BITS(COUNT_BITS)
  ) finder (
      .clk,
      .rst,
      .begins,
      .columns,
      .rows,
      .tiles,
      .request(),
      .granted,
      .end_place,
      .tile,
      .valid(found),
      .ready(pixel_valid && pixel_ready && last_pixel),
      .window,
      .first,
      .entries()
  );

  assign end_tile = tile[TILE_BITS-1:0];
  assign width = (COLUMN_BITS + 1)'(window.end_column - window.first_column);
  assign height = (ROW_BITS + 1)'(window.end_row - window.first_row);
  assign last_pixel = pixel == last;
  assign pixel_valid = found && may_be_written;
  assign place = first + 32'(pixel);
  always_ff @(posedge clk) begin
    // A tile is found four cycles after the one before. Its window takes the first, and its pixels take two.
    may_be_written <= tile < turn;
    pixels <= (COLUMN_BITS + ROW_BITS)'(width * height);
    last <= pixels - 1'b1;
    if (pixel_valid && pixel_ready) pixel <= last_pixel ? '0 : pixel + 1'b1;
    if (begins) pixel <= 0;
  end
endmodule
