// Design standard24: widths and packet of the kernel. Generated, not to be edited:
// `cargo run -p splatline-rtl --example rtl -- package`
package splatline_pkg;

  localparam int MANTISSA = 28;  // magnitude bits of a mantissa
  localparam int SUBPIXEL = 24;  // fraction bits of a centre
  localparam int RADIAL = 27;  // fraction bits of the radial index
  localparam int TABLE = 12;  // log2 of the footprint table's intervals
  localparam int INTERPOLATION = 15;  // bits of the position within an interval
  localparam int WEIGHT = 26;  // fraction bits of a table entry
  localparam int STEP_BITS = 24;  // bits of the largest step between two entries
  localparam int PEAK = 28;  // fraction bits of a peak opacity
  localparam int ALPHA = 26;  // fraction bits of an opacity
  localparam int TRANSMITTANCE = 30;  // fraction bits of the deep alpha channel
  localparam int COLOUR = 24;  // fraction bits of a splat's colour
  localparam int COLOUR_BITS = 28;  // and all of them
  localparam int ACCUMULATOR = 26;  // fraction bits of a pixel's colour
  localparam int SUM_BITS = 31;  // and all of them, see blend.sv
  localparam logic TIES_TO_EVEN = 1'b0;  // rounding of opacity, share and sums: halves to even, or up
  localparam int BLOCK_BITS = 5;  // log2 of the columns, and of the rows, between two seeds
  localparam int GUARD = 8;  // bits below the lanes' and the rows' units from which seeds are balanced
  localparam int VERTICAL = 31;  // fraction bits of C dy^2 down the rows
  localparam int TILE_COLUMN_BITS = 5;  // log2 of a tile's columns
  localparam int TILE_ROW_BITS = 5;  // log2 of a tile's rows
  localparam int PACKET_BITS = 473;  // bits of a packet
  localparam logic [3:0] PACKET_VERSION = 4'd3;

  typedef struct packed {
    logic [27:0] blue;  // 24 fraction bits
    logic [27:0] green;  // 24 fraction bits
    logic [27:0] red;  // 24 fraction bits
    logic [31:0] peak;  // 28 fraction bits
    logic [31:0] cutoff;  // 28 fraction bits
    logic signed [9:0] vertical_exponent;
    logic [27:0] vertical_mantissa;
    logic signed [9:0] shear_exponent;
    logic signed [28:0] shear_mantissa;
    logic signed [9:0] squared_width_exponent;
    logic [27:0] squared_width_mantissa;
    logic signed [9:0] horizontal_exponent;
    logic [27:0] horizontal_mantissa;
    logic [15:0] end_row;
    logic [15:0] end_column;
    logic [15:0] first_row;
    logic [15:0] first_column;
    logic signed [51:0] centre_v;  // 24 fraction bits
    logic signed [51:0] centre_u;  // 24 fraction bits
    logic [3:0] version;
  } footprint_t;

  // What the units hand to each other; formats are those of the kernel's structs of the same names
  // (src/raster/spans.rs, src/raster/mod.rs). Kept in types.svh, which the generator copies in here: Yosys knows no
  // types across packages.

  // Bits of an exponent and of a shift: those of a packet have 10. splat_primitive.sv checks that sums of them have
  // room.
  localparam int EXPONENT = 12;

  // The part of the screen that the tile buffer holds: columns and rows first .. end.
  typedef struct packed {
    logic [15:0] first_column;
    logic [15:0] first_row;
    logic [15:0] end_column;
    logic [15:0] end_row;
  } window_t;

  // The rules of blending at the design's widths (src/blend/mod.rs, `Blend`).
  typedef struct packed {
    logic [ALPHA:0] alpha_max;
    logic [PEAK+WEIGHT:0] least;  // products of peak and weight below it are skipped, UQ1.(peak + weight)
    logic [TRANSMITTANCE:0] minimum_transmittance;
    logic omit_finishing;
    logic wide_table;  // The footprint table ends at r = 16, otherwise at r = 4.
  } rules_t;

  // What blending needs of a splat.
  typedef struct packed {
    logic [PEAK+3:0] peak;  // UQ4.peak
    logic [COLOUR_BITS-1:0] red;  // Q.colour
    logic [COLOUR_BITS-1:0] green;
    logic [COLOUR_BITS-1:0] blue;
  } paint_t;

  // What the rows of a splat need (`EllipseSpans`, `HalfWidth` and `Seed`), constant from row to row.
  typedef struct packed {
    logic [15:0] start_column;  // columns of the footprint's box in the window
    logic [15:0] end_column;
    logic [VERTICAL+4:0] reach;  // cut-off and slack, UQ5.vertical
    logic coarse;  // xc has SUBPIXEL - 2 fraction bits, otherwise SUBPIXEL + 8
    logic [MANTISSA-1:0] squared_width;
    logic squared_width_odd;
    logic signed [EXPONENT-1:0] squared_width_power;
    logic [MANTISSA-1:0] horizontal;
    logic [5:0] drop_dx;
    logic signed [EXPONENT-1:0] drop_first;
    // `Balance`, Q.radial, low words: the lanes' arithmetic is modulo 2^32.
    logic [31:0] second;
    logic [31:0] unit;
    logic [31:0] balance;
    logic [RADIAL+4:0] cutoff;  // UQ4.radial, may round up to 16
    paint_t paint;
  } shape_t;

  // Where a splat's rows begin and how they change.
  typedef struct packed {
    logic [TILE_ROW_BITS-1:0] row;  // within the tile
    logic [TILE_ROW_BITS:0] rows;  // rows in the window
    logic signed [SUBPIXEL+27:0] centre;  // xc - 1/2, and its change
    logic signed [SUBPIXEL+27:0] shear;
    logic signed [VERTICAL+5:0] vertical;  // C dy^2, Q5.vertical, and its differences
    logic signed [VERTICAL+5:0] first;
    logic signed [VERTICAL+5:0] second;
  } start_t;

  // Adjacent pixels of one row, at least one (`Span`).
  typedef struct packed {
    logic [TILE_ROW_BITS-1:0] row;  // within the tile
    logic [TILE_COLUMN_BITS-1:0] column;
    logic [TILE_COLUMN_BITS:0] count;
    logic [31:0] radial;  // Q.radial, and its differences
    logic [31:0] first;
    logic [31:0] second;
    logic [RADIAL+4:0] cutoff;
  } run_t;

endpackage
