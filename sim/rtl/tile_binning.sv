// Lists of the splats of each tile: those whose box meets it, in the order in which the splats come (`Bins` of
// sim/machine/src/workload).
//
//   every splat once, in any order: its tiles are counted -> sums -> every splat again, nearest first:
//   its number goes to the end of its tiles' lists
//
// Lists follow each other without a gap, tile by tile, four numbers in a word of the memory. A splat takes a cycle, and
// one for each of its tiles, both times. Where a tile's list ends can be read when all is done; it begins where that of
// the tile before ends.
module tile_binning #(
    parameter TILE_BITS = 12,
    parameter COUNT_BITS = 24
) (
    input logic clk,
    input logic rst,
    input logic begins,  // a picture: counters are cleared
    input logic [31:0] base,
    input logic [11:0] tile_columns,
    input logic [TILE_BITS:0] tiles,
    input logic [COUNT_BITS-1:0] most,  // entries for which there is room
    input logic box_valid,  // a splat to be counted
    output logic box_ready,
    input logic [47:0] box,  // tiles: last row, last column, first row, first column
    input logic ends,  // all have been counted
    input logic [COUNT_BITS-1:0] splats,
    input logic splat_valid,  // a splat for the lists
    output logic splat_ready,
    input logic [127:48] splat,  // box and number
    output logic write_valid,
    input logic write_ready,
    output logic [31:0] write_address,
    output logic [31:0] write_number,
    output logic [3:0] write_strobe,
    output logic done,
    output logic counted,  // all sums are there, and `full` is known
    output logic full,  // no room: nothing was listed
    output logic [COUNT_BITS-1:0] entries,
    input logic [TILE_BITS-1:0] end_tile,
    output logic [COUNT_BITS-1:0] end_place  // two cycles later, when done
);
  generate
    if (TILE_BITS < 2 || TILE_BITS > 12) begin : gen_illegal
      $error("tile_binning: TILE_BITS from 2 to 12");
    end
  endgenerate

  typedef enum logic [2:0] {
    CLEAR,
    COUNT,
    SUM,
    FILL,
    DONE
  } state_t;
  state_t state;

  // Entries of each tile; then where its next one goes. Block RAM is slow: what is read has a register of its own
  // before anything is made of it.
  (* ram_style = "block", no_rw_check *) logic [COUNT_BITS-1:0] counters[0:(1<<TILE_BITS)-1];
  logic [TILE_BITS-1:0] read_tile, changed_tile;
  logic [COUNT_BITS-1:0] counter_read, counter_found, counter, after, changed;
  assign after = counter + 1'b1;
  assign end_place = counter_found;

  // Tiles on their way: one is asked for its counter, one is next, one enters, the last one has. Between two splats
  // there is a cycle, so that of the three before it the second and the third may be of the same tile: then its counter
  // was read too early, and what they made of it is taken. Nothing moves while an entry waits to be written.
  logic requested, next, enters, entered, changes, moves, follows, changed_meanwhile;
  logic [TILE_BITS-1:0] requested_tile, next_tile, entering_tile, entered_tile;
  logic [COUNT_BITS-1:0] after_last, meanwhile;
  assign follows = enters && requested_tile == entering_tile;
  always_ff @(posedge clk) begin
    if (moves) begin
      counter_read <= counters[read_tile];
      counter_found <= counter_read;
      counter <= changed_meanwhile ? meanwhile : counter_found;
      {requested_tile, next_tile, entering_tile, entered_tile} <= {read_tile, requested_tile, next_tile, entering_tile};
      after_last <= after;
      changed_meanwhile <= follows || (entered && requested_tile == entered_tile);
      meanwhile <= follows ? after : after_last;
    end
    if (changes) counters[changed_tile] <= changed;
  end

  // The walk over a splat's tiles.
  logic walking, counts, coming, last_column, last_row;
  logic [11:0] column, row, first, last, last_of_rows;
  // A row's first tile stands in a register, and the column is added behind it: behind the product it would be the
  // longest way of the sorter.
  logic [TILE_BITS-1:0] tile, tile_of_row;
  // A splat passes two registers before its walk: what brings it, the product and the walk's first step have a cycle
  // each. `free`, not its opposite, is a register, since a multiplier's own registers have no inverted enable.
  logic free, placed_free;
  logic [47:0] waiting_box, placed_box;
  logic [31:0] waiting_number, placed_number, number, next_number, entry;
  logic [TILE_BITS-1:0] first_tile_of_row;
  assign counts = state == COUNT;
  assign moves = !write_valid || write_ready;
  assign box_ready = counts && free;
  assign splat_ready = state == FILL && free;
  assign coming = !placed_free && !walking && moves;
  assign tile = tile_of_row + TILE_BITS'(column);
  assign last_column = column == last;
  assign last_row = row == last_of_rows;

  // Tiles one after the other, for clearing and for the sums.
  logic [TILE_BITS:0] index;
  logic [COUNT_BITS-1:0] sum, left;

  always_comb begin
    read_tile = tile;
    changes = enters && moves;
    changed_tile = entering_tile;
    changed = after;
    case (state)
      CLEAR: begin
        changes = 1;
        changed_tile = index[TILE_BITS-1:0];
        changed = 0;
      end
      SUM: begin
        read_tile = index[TILE_BITS-1:0];
        changed = sum;
      end
      DONE: read_tile = end_tile;
      default: ;
    endcase
  end

  assign write_valid = state == FILL && enters;
  assign write_address = base + 32'(counter[COUNT_BITS-1:2]);
  assign write_strobe = 4'd1 << counter[1:0];
  assign write_number = entry;
  assign counted = state == FILL || state == DONE;
  assign done = state == DONE;

  always_ff @(posedge clk) begin
    if (free) begin
      free <= counts ? !box_valid : !(splat_valid && splat_ready);
      waiting_box <= counts ? box : splat[127:80];
      waiting_number <= splat[79:48];
    end else if (placed_free) free <= 1;
    if (placed_free) begin
      placed_free <= free;
      {placed_box, placed_number} <= {waiting_box, waiting_number};
      first_tile_of_row <= TILE_BITS'(waiting_box[23:12] * tile_columns);
    end else if (coming) placed_free <= 1;
    if (moves) begin
      {requested, next, enters, entered} <= {walking, requested, next, enters};
      {next_number, entry} <= {number, next_number};
      if (coming) begin
        {last_of_rows, last, row, column} <= placed_box;
        first <= placed_box[11:0];
        tile_of_row <= first_tile_of_row;
        number <= placed_number;
        walking <= 1;
      end else if (walking) begin
        column <= last_column ? first : column + 1'b1;
        if (last_column) begin
          row <= row + 1'b1;
          tile_of_row <= tile_of_row + TILE_BITS'(tile_columns);
          if (last_row) walking <= 0;
        end
      end
    end
    case (state)
      CLEAR: begin
        index <= index + 1'b1;
        if (index + 1'b1 == tiles) state <= COUNT;
        {walking, requested, next, enters, entered} <= 0;
        {free, placed_free} <= 2'b11;
      end
      COUNT: begin
        if (ends && !box_valid && free && placed_free && !walking && !requested && !next && !enters) state <= SUM;
        {index, sum} <= 0;
      end
      SUM: begin
        index <= index + 1'b1;
        requested <= index < tiles;
        if (enters) sum <= sum + counter;
        if (index >= tiles && !requested && !next && !enters) begin
          entries <= sum;
          full <= sum > most;
          left <= splats;
          state <= sum == 0 || sum > most ? DONE : FILL;
        end
      end
      FILL: begin
        if (coming) left <= left - 1'b1;
        if (left == 0 && !walking && !requested && !next && !enters) state <= DONE;
      end
      default: ;
    endcase
    if (begins || rst) begin
      state <= rst ? DONE : CLEAR;
      {index, entries, full} <= 0;
    end
  end
endmodule
