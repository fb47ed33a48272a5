// One pixel lane: takes a run and yields one pixel a cycle, its radial index by two additions (`Run::radials`,
// `paint_run`).
//
// Only pixels inside the footprint, r < c, leave the lane; the others cost their cycle and nothing more. A lane takes
// its next run in the cycle of the last pixel of the one before, unless a pixel of it would come to a place that it has
// been at less than INTERVAL cycles before, whose new value is still on its way: then it waits in front of the run.
// Within a run all pixels differ, so that nothing has to be compared but the last pixels of the runs before with the
// columns of the run to come. A run waits for that comparison in the cycle after it came to the queue's front, so that
// runs of a single pixel take two cycles.
module lane #(
    parameter INTERVAL = 7,
    parameter SLOT_BITS = 4
) (
    input logic clk,
    input logic rst,
    input logic advance,
    input logic run_valid,
    output logic run_ready,
    input splatline_pkg::run_t run,
    input logic [SLOT_BITS-1:0] run_slot,
    output logic pixel_valid,
    output logic [splatline_pkg::RADIAL+3:0] radial,  // UQ4.radial, below the cut-off
    output logic [splatline_pkg::TILE_ROW_BITS+splatline_pkg::TILE_COLUMN_BITS-1:0] address,  // row, column within the tile
    output logic [SLOT_BITS-1:0] slot,  // its run's number
    output logic idle
);
  localparam RADIAL = splatline_pkg::RADIAL;
  localparam COLUMN_BITS = splatline_pkg::TILE_COLUMN_BITS;
  localparam PLACE = splatline_pkg::TILE_ROW_BITS + COLUMN_BITS;

  logic active, final_pixel, last;
  splatline_pkg::run_t at;

  // Places of the last pixels, as they will be after this cycle: the lowest is the one that leaves then, place i will
  // have left i cycles before.
  localparam LEFT = INTERVAL - 3;
  logic [LEFT-1:0] left_valid;
  logic [PLACE*LEFT-1:0] left;
  logic [LEFT+1:0] been_valid, meets;
  logic [PLACE*(LEFT+2)-1:0] been;
  logic [PLACE-1:0] first;
  assign first = {run.row, run.column};
  // Whether the run has a pixel so many columns on.
  logic [INTERVAL-2:0] reaches;
  assign been_valid = {left_valid, active, active && !final_pixel};
  assign been = {left, address, address};
  always_ff @(posedge clk) begin
    if (rst) left_valid <= 0;
    else if (advance) left_valid <= been_valid[LEFT:1];
    if (advance) left <= been[PLACE*(LEFT+1)-1:PLACE];
  end
  genvar i;
  generate
    for (i = 0; i < INTERVAL - 1; i = i + 1) begin : gen_reaches
      assign reaches[i] = run.count > (COLUMN_BITS + 1)'(i);
    end
    for (i = 0; i <= LEFT + 1; i = i + 1) begin : gen_been
      // The run comes to that column `ahead` cycles after its first pixel, which would be i + 1 cycles after the place
      // was left. The pixel that leaves next is a column further than the one that leaves now. Few distances matter:
      // they are compared one by one, beside the run's length and not behind another subtraction.
      localparam NEXT = i == 0 ? 1 : 0;
      logic [COLUMN_BITS:0] ahead;
      logic too_early;
      assign ahead = {1'b0, been[PLACE*i+:COLUMN_BITS]} - {1'b0, first[COLUMN_BITS-1:0]};
      always_comb begin
        too_early = 0;
        for (int d = 0; d < INTERVAL - 1 - i; d = d + 1) too_early = too_early || (ahead == (COLUMN_BITS + 1)'(d - NEXT) && reaches[d]);
      end
      assign meets[i] = been_valid[i] && been[PLACE*i+COLUMN_BITS+:PLACE-COLUMN_BITS] == first[PLACE-1:COLUMN_BITS] && too_early;
    end
  endgenerate

  // Whether the run may begin is known in the cycle after it came, so that the comparison and what hangs on it have a
  // cycle each.
  logic apart;
  assign run_ready = advance && last && apart;
  assign idle = !active;

  always_ff @(posedge clk) begin
    if (rst) apart <= 0;
    else if (advance) apart <= run_valid && !run_ready && meets == 0;
    if (rst) active <= 0;
    else if (advance && last) active <= apart;
    // `last` is `!active || final_pixel`, with a register of its own, since all that a run's beginning moves hangs on
    // it.
    if (rst) last <= 1;
    else if (advance) last <= last ? !apart || run.count == (COLUMN_BITS + 1)'(1) : at.count == (COLUMN_BITS + 1)'(2);
    if (advance) begin
      if (last) begin
        at <= run;
        slot <= run_slot;
        final_pixel <= run.count == (COLUMN_BITS + 1)'(1);
      end else begin
        at.column <= at.column + 1'b1;
        at.count <= at.count - 1'b1;
        at.radial <= at.radial + at.first;
        at.first <= at.first + at.second;
        final_pixel <= at.count == (COLUMN_BITS + 1)'(2);
      end
    end
  end

  // Negative indices are rounding noise around 0.
  logic [31:0] clamped;
  assign clamped = at.radial[31] ? 32'd0 : at.radial;
  assign pixel_valid = active && clamped < 32'(at.cutoff);
  assign radial = clamped[RADIAL+3:0];
  assign address = {at.row, at.column};

`ifdef FORMAL
`include "formal/lane_properties.svh"
`endif
endmodule
