// The primitive's units as what the end of a tile needs to know of them: what came in and did not leave yet, and
// `idle`, which says that nothing is. All else is free: when they take, what they give, and how long it takes. For
// `rtl -- formal`, in place of the units of the same names.

module splat_setup #(
    parameter INTERVAL = 4
) (
    input logic clk,
    input logic rst,
    input splatline_pkg::window_t window,
    input logic footprint_valid,
    output logic footprint_ready,
    input splatline_pkg::footprint_t footprint,
    output logic splat_valid,
    input logic splat_ready,
    output splatline_pkg::start_t start,
    output splatline_pkg::shape_t shape,
    output logic idle
);
  (* anyseq *) logic takes, gives;
  logic [2:0] inside;
  assign idle = inside == 0;
  assign footprint_ready = takes && inside != 7;
  assign splat_valid = gives && inside != 0;
  always_ff @(posedge clk)
    if (rst) inside <= 0;
    else inside <= inside + {2'd0, footprint_valid && footprint_ready} - {2'd0, splat_valid && splat_ready};
endmodule

// A splat leaves with one of its rows, or with none.
module row_generator #(
    parameter LANE_BITS = 0,
    parameter INTERVAL = 1,
    parameter WIDE_MULTIPLIERS = 4
) (
    input logic clk,
    input logic rst,
    input logic splat_valid,
    output logic splat_ready,
    input splatline_pkg::start_t start,
    input splatline_pkg::shape_t shape,
    output logic slot_valid,
    input logic slot_ready,
    output logic slot_has_run,
    output logic next_has_run,
    output logic [splatline_pkg::TILE_ROW_BITS-1:0] next_lane,
    output splatline_pkg::run_t run,
    output splatline_pkg::paint_t paint,
    output logic idle
);
  (* anyseq *) logic takes, gives, has_run, leaves;
  (* anyseq *) logic [splatline_pkg::TILE_ROW_BITS-1:0] row;
  assign next_has_run = has_run;
  assign next_lane = row & splatline_pkg::TILE_ROW_BITS'((1 << LANE_BITS) - 1);
  logic [2:0] inside;
  assign idle = inside == 0;
  assign splat_ready = takes && inside != 7;
  assign slot_valid = gives && inside != 0;
  always_ff @(posedge clk) {slot_has_run, run.row} <= {has_run, row};
  always_ff @(posedge clk)
    if (rst) inside <= 0;
    else inside <= inside + {2'd0, splat_valid && splat_ready} - {2'd0, slot_valid && slot_ready && leaves};
endmodule

module run_queue #(
    parameter DEPTH = 8,
    parameter SLOTS = 16
) (
    input logic clk,
    input logic rst,
    input logic in_valid,
    output logic in_ready,
    output logic ready_next,
    input splatline_pkg::run_t in_run,
    output logic [$clog2(SLOTS)-1:0] in_slot,
    output logic out_valid,
    input logic out_ready,
    output splatline_pkg::run_t out_run,
    output logic [$clog2(SLOTS)-1:0] out_slot,
    output logic empty
);
  (* anyseq *) logic takes, gives;
  logic [2:0] inside;
  assign empty = inside == 0;
  // No more than one comes before the next cycle.
  assign ready_next = takes && inside < 6;
  always_ff @(posedge clk) in_ready <= ready_next;
  assign out_valid = gives && inside != 0;
  always_ff @(posedge clk)
    if (rst) inside <= 0;
    else inside <= inside + {2'd0, in_valid && in_ready} - {2'd0, out_valid && out_ready};
endmodule

// A run gives pixels in its cycles, of which the last is any.
module lane #(
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
    output logic [splatline_pkg::RADIAL+3:0] radial,
    output logic [splatline_pkg::TILE_ROW_BITS+splatline_pkg::TILE_COLUMN_BITS-1:0] address,
    output logic [SLOT_BITS-1:0] slot,
    output logic idle
);
  (* anyseq *) logic takes, gives, ends;
  logic active;
  assign idle = !active;
  assign run_ready = takes && advance && (!active || ends);
  assign pixel_valid = gives && active;
  always_ff @(posedge clk)
    if (rst) active <= 0;
    else if (advance) active <= (run_valid && run_ready) || (active && !ends);
endmodule

module footprint_table (
    input logic clk,
    input logic advance,
    input logic write_valid,
    input logic [splatline_pkg::TABLE:0] write_index,
    input logic [splatline_pkg::WEIGHT:0] write_low,
    input logic [splatline_pkg::STEP_BITS-1:0] write_step,
    input logic wide_table,
    input logic [splatline_pkg::RADIAL+3:0] radial,
    output logic [splatline_pkg::WEIGHT:0] weight
);
endmodule

// A pixel leaves with what it writes, or without.
module blend #(
    parameter ADDRESS = 10,
    parameter SLOT_BITS = 4,
    parameter ADDED_BITS = 4,
    parameter WIDE_MULTIPLIERS = 4
) (
    input logic clk,
    input logic rst,
    input logic advance,
    input splatline_pkg::rules_t rules,
    input logic pixel_valid,
    input logic [ADDRESS-1:0] pixel_address,
    input logic [splatline_pkg::WEIGHT:0] weight,
    input logic [splatline_pkg::PEAK+3:0] peak,
    input logic [SLOT_BITS-1:0] pixel_slot,
    output logic [SLOT_BITS-1:0] colour_slot,
    input logic [3*splatline_pkg::COLOUR_BITS-1:0] colour11,
    input logic [53:0] colour_sums11,
    output logic [ADDRESS-1:0] transmittance_read_address,
    input logic [splatline_pkg::TRANSMITTANCE+1:0] transmittance_read,
    output logic transmittance_write,
    output logic [ADDRESS-1:0] transmittance_write_address,
    output logic [splatline_pkg::TRANSMITTANCE+1:0] transmittance_word,
    output logic [ADDRESS-1:0] colour_read_address,
    input logic [3*splatline_pkg::SUM_BITS-1:0] colour_read,
    output logic colour_write,
    output logic [ADDRESS-1:0] colour_write_address,
    output logic [3*splatline_pkg::SUM_BITS-1:0] colour_word,
    output logic idle
);
  (* anyseq *) logic writes, leaves;
  logic [3:0] inside;
  assign idle = inside == 0;
  assign transmittance_write = writes && inside != 0;
  assign colour_write = transmittance_write;
  always_comb assume (inside != 15 || leaves);
  always_ff @(posedge clk)
    if (rst) inside <= 0;
    else if (advance) inside <= inside + {3'd0, pixel_valid} - {3'd0, inside != 0 && leaves};
endmodule

module tile_buffer #(
    parameter BITS = 32,
    parameter ADDRESS = 10,
    parameter [BITS-1:0] CLEAR = 0
) (
    input logic clk,
    input logic clears,
    input logic clear,
    input logic [ADDRESS-1:0] clear_address,
    input logic advance,
    input logic write,
    input logic [ADDRESS-1:0] write_address,
    input logic [BITS-1:0] write_word,
    input logic read,
    input logic [ADDRESS-1:0] read_address,
    output logic [BITS-1:0] read_word
);
endmodule

module tile_colours #(
    parameter BITS = 32,
    parameter ADDRESS = 10,
    parameter BLOCK_WORDS = 512
) (
    input logic clk,
    input logic drawn,
    input logic advance,
    input logic write,
    input logic [ADDRESS-1:0] write_address,
    input logic [BITS-1:0] write_word,
    input logic [ADDRESS-1:0] read_address,
    output logic [BITS-1:0] read_word,
    input logic scan,
    input logic [ADDRESS-1:0] scan_address,
    output logic [BITS-1:0] scan_word
);
endmodule
