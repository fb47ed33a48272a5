// One pixel lane: takes a run and yields one pixel a cycle, its radial index by two additions (`Run::radials`, `paint_run`).
//
// Only pixels inside the footprint, r < c, leave the lane; the others cost their cycle and nothing more. A lane takes its
// next run in the cycle of the last pixel of the one before.
module lane (
    input logic clk,
    input logic rst,
    input logic advance,
    input logic run_valid,
    output logic run_ready,
    input splatline_pkg::run_t run,
    output logic pixel_valid,
    output logic [splatline_pkg::RADIAL+3:0] radial,  // UQ4.radial, below the cut-off
    output logic [splatline_pkg::TILE_ROW_BITS+splatline_pkg::TILE_COLUMN_BITS-1:0] address,  // row, column within the tile
    output splatline_pkg::paint_t paint,
    output logic idle
);
  localparam RADIAL = splatline_pkg::RADIAL;

  logic active;
  splatline_pkg::run_t at;
  logic last;

  assign last = !active || at.count == 7'd1;
  assign run_ready = advance && last;
  assign idle = !active;

  always_ff @(posedge clk) begin
    if (rst) active <= 0;
    else if (advance && last) active <= run_valid;
    if (advance) begin
      if (last) at <= run;
      else begin
        at.column <= at.column + 16'd1;
        at.count <= at.count - 7'd1;
        at.radial <= at.radial + at.first;
        at.first <= at.first + at.second;
      end
    end
  end

  // Negative indices are rounding noise around 0.
  logic [31:0] clamped;
  assign clamped = at.radial[31] ? 32'd0 : at.radial;
  assign pixel_valid = active && clamped < 32'(at.paint.cutoff);
  assign radial = clamped[RADIAL+3:0];
  assign address = {at.row[splatline_pkg::TILE_ROW_BITS-1:0], at.column[splatline_pkg::TILE_COLUMN_BITS-1:0]};
  assign paint = at.paint;
endmodule
