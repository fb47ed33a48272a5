// The hardware splat primitive: packets of splats in, a tile of finished pixels out.
//
//   packet_decode -> splat_setup -> row_generator -> run_queue -> lane -> footprint_table -> blend <-> tile_buffer
//                                                    `------------- once for every lane -------------'
//
// Lane l owns the tile's rows y with y mod LANES = l and the bank that holds them. So a pixel only ever meets one lane, splats
// keep their order at every pixel without any interlock, and lanes work on different rows, where short runs leave none idle.
//
// A tile: `tile` (the window, within one aligned TILE_COLUMNS x TILE_ROWS block) clears the buffer; packets follow, nearest first;
// `finish` waits for the last pixel and starts the read-out, row by row; after its last pixel the next tile may begin.
module splat_primitive #(
    parameter LANES = 1,
    parameter QUEUE = 8
) (
    input logic clk,
    input logic rst,
    input splatline_pkg::rules_t rules,
    // The footprint table of all lanes: an entry and the step down to the next.
    input logic table_valid,
    input logic [splatline_pkg::TABLE:0] table_index,
    input logic [splatline_pkg::WEIGHT:0] table_low,
    input logic [splatline_pkg::STEP_BITS-1:0] table_step,
    input logic tile_valid,
    output logic tile_ready,
    input splatline_pkg::window_t tile,
    input logic packet_valid,
    output logic packet_ready,
    input logic [splatline_pkg::PACKET_BITS-1:0] packet,
    input logic finish_valid,
    output logic finish_ready,
    output logic pixel_valid,
    input logic pixel_ready,
    output logic [splatline_pkg::TRANSMITTANCE+1:0] pixel_depth,  // finished flag, UQ1.transmittance
    output logic [3*splatline_pkg::SUM_BITS-1:0] pixel_colour,  // blue, green, red, UQ5.accumulator
    // Lanes move only in cycles in which this is set: where the tile buffer shares its memory's ports.
    input logic lanes_enable,
    output logic raster_idle,  // every packet taken has reached its last pixel
    output logic idle,  // and that pixel is in the tile buffer
    output logic [15:0] foreign_packets
);
  localparam LANE_BITS = LANES == 1 ? 0 : $clog2(LANES);
  localparam COLUMN_BITS = splatline_pkg::TILE_COLUMN_BITS;
  localparam ROW_BITS = splatline_pkg::TILE_ROW_BITS;
  localparam ADDRESS = COLUMN_BITS + ROW_BITS - LANE_BITS;
  localparam DEPTH_BITS = splatline_pkg::TRANSMITTANCE + 2;
  localparam COLOUR_BITS = 3 * splatline_pkg::SUM_BITS;

  typedef enum logic [1:0] {
    IDLE,
    CLEAR,
    DRAW,
    READ
  } state_t;
  state_t state;
  splatline_pkg::window_t window;

  assign tile_ready = state == IDLE;
  // A packet offered together with `finish` still belongs to this tile: `finish` waits.
  assign finish_ready = state == DRAW && idle && !packet_valid;

  // Packets to runs.
  logic footprint_valid, footprint_ready, splat_valid, splat_ready, run_valid, run_ready, setup_idle, rows_idle;
  splatline_pkg::footprint_t footprint;
  splatline_pkg::start_t start;
  splatline_pkg::shape_t shape;
  splatline_pkg::run_t run;
  logic decode_ready;
  assign packet_ready = decode_ready && state == DRAW;

  packet_decode decode (
      .clk,
      .rst,
      .packet_valid(packet_valid && state == DRAW),
      .packet_ready(decode_ready),
      .packet,
      .footprint_valid,
      .footprint_ready,
      .footprint,
      .foreign_packets
  );
  splat_setup setup (
      .clk,
      .rst,
      .window,
      .footprint_valid,
      .footprint_ready,
      .footprint,
      .splat_valid,
      .splat_ready,
      .start,
      .shape,
      .idle(setup_idle)
  );
  row_generator rows (
      .clk,
      .rst,
      .splat_valid,
      .splat_ready,
      .start,
      .shape,
      .run_valid,
      .run_ready,
      .run,
      .idle(rows_idle)
  );

  // The scan of clearing and reading: row and column within the block.
  logic [ROW_BITS-1:0] scan_row;
  logic [COLUMN_BITS-1:0] scan_column;
  logic [ADDRESS-1:0] clear_address;
  logic scan_last_column, scan_last_row, scan_valid, scan_moves, window_has_pixels;
  assign window_has_pixels = window.first_column < window.last_column && window.first_row < window.last_row;
  assign scan_last_column = scan_column == COLUMN_BITS'(window.last_column - 16'd1);
  assign scan_last_row = scan_row == ROW_BITS'(window.last_row - 16'd1);
  assign scan_moves = !pixel_valid || pixel_ready;

  always_ff @(posedge clk) begin
    if (rst) begin
      state <= IDLE;
      pixel_valid <= 0;
      scan_valid <= 0;
    end else begin
      case (state)
        IDLE:
        if (tile_valid) begin
          state <= CLEAR;
          window <= tile;
          clear_address <= 0;
        end
        CLEAR: begin
          clear_address <= clear_address + 1'b1;
          if (&clear_address) state <= DRAW;
        end
        DRAW: begin
          scan_row <= ROW_BITS'(window.first_row);
          scan_column <= COLUMN_BITS'(window.first_column);
          if (finish_valid && finish_ready) begin
            state <= READ;
            scan_valid <= window_has_pixels;
          end
        end
        READ:
        if (scan_moves) begin
          pixel_valid <= scan_valid;
          if (scan_last_column) begin
            scan_column <= COLUMN_BITS'(window.first_column);
            scan_row <= scan_row + 1'b1;
          end else scan_column <= scan_column + 1'b1;
          if (scan_last_column && scan_last_row) scan_valid <= 0;
          if (!scan_valid) state <= IDLE;
        end
      endcase
    end
  end

  // The lanes.
  logic [LANES-1:0] queue_ready, lane_idle, pixels_idle;
  logic [LANES*DEPTH_BITS-1:0] depths;
  logic [LANES*COLOUR_BITS-1:0] colours;
  logic [ROW_BITS-1:0] read_row;
  always_ff @(posedge clk) if (scan_moves) read_row <= scan_row;

  genvar l;
  generate
    if (LANES == 1) begin : gen_single
      assign run_ready = queue_ready[0];
      assign pixel_depth = depths;
      assign pixel_colour = colours;
    end else begin : gen_banked
      assign run_ready = queue_ready[run.row[LANE_BITS-1:0]];
      assign pixel_depth = depths[read_row[LANE_BITS-1:0]*DEPTH_BITS+:DEPTH_BITS];
      assign pixel_colour = colours[read_row[LANE_BITS-1:0]*COLOUR_BITS+:COLOUR_BITS];
    end

    for (l = 0; l < LANES; l = l + 1) begin : gen_lane
      logic mine, queued, taken, inside0, inside1, inside2, lane_quiet, blend_quiet, moves;
      splatline_pkg::run_t queued_run;
      logic [splatline_pkg::RADIAL+3:0] radial;
      logic [ROW_BITS+COLUMN_BITS-1:0] place;
      logic [ADDRESS-1:0] address0, address1, address2;
      splatline_pkg::paint_t paint0, paint1, paint2;
      logic [splatline_pkg::WEIGHT:0] weight;

      if (LANES == 1) begin : gen_all_rows
        assign mine = 1'b1;
        assign address0 = place;
      end else begin : gen_own_rows
        assign mine = run.row[LANE_BITS-1:0] == l[LANE_BITS-1:0];
        assign address0 = {place[ROW_BITS+COLUMN_BITS-1:COLUMN_BITS+LANE_BITS], place[COLUMN_BITS-1:0]};
      end

      assign moves = lanes_enable && state == DRAW;

      run_queue #(
          .DEPTH(QUEUE)
      ) queue (
          .clk,
          .rst,
          .in_valid(run_valid && mine),
          .in_ready(queue_ready[l]),
          .in_run(run),
          .out_valid(queued),
          .out_ready(taken),
          .out_run(queued_run)
      );
      lane pixels (
          .clk,
          .rst,
          .advance(moves),
          .run_valid(queued),
          .run_ready(taken),
          .run(queued_run),
          .pixel_valid(inside0),
          .radial,
          .address(place),
          .paint(paint0),
          .idle(lane_quiet)
      );
      footprint_table kernel (
          .clk,
          .advance(moves),
          .write_valid(table_valid),
          .write_index(table_index),
          .write_low(table_low),
          .write_step(table_step),
          .wide_table(rules.wide_table),
          .radial,
          .weight
      );
      always_ff @(posedge clk) begin
        if (rst) begin
          inside1 <= 0;
          inside2 <= 0;
        end else if (moves) begin
          inside1 <= inside0;
          inside2 <= inside1;
        end
        if (moves) begin
          address1 <= address0;
          address2 <= address1;
          paint1 <= paint0;
          paint2 <= paint1;
        end
      end

      logic depth_write, colour_write;
      logic [ADDRESS-1:0] depth_read_address, depth_write_address, colour_read_address, colour_write_address;
      logic [DEPTH_BITS-1:0] depth_word;
      logic [COLOUR_BITS-1:0] colour_word;
      blend #(
          .ADDRESS(ADDRESS)
      ) over (
          .clk,
          .rst,
          .advance(moves),
          .rules,
          .pixel_valid(inside2),
          .pixel_address(address2),
          .weight,
          .paint(paint2),
          .depth_read_address,
          .depth_read(depths[l*DEPTH_BITS+:DEPTH_BITS]),
          .depth_write,
          .depth_write_address,
          .depth_word,
          .colour_read_address,
          .colour_read(colours[l*COLOUR_BITS+:COLOUR_BITS]),
          .colour_write,
          .colour_write_address,
          .colour_word,
          .idle(blend_quiet)
      );

      // While drawing, the lane owns its bank; otherwise the scan does.
      logic clearing, reads;
      logic [ADDRESS-1:0] scan_address;
      assign clearing = state == CLEAR;
      assign reads = state == READ ? scan_moves : moves;
      if (LANES == 1) begin : gen_scan_all
        assign scan_address = {scan_row, scan_column};
      end else begin : gen_scan_own
        assign scan_address = {scan_row[ROW_BITS-1:LANE_BITS], scan_column};
      end
      tile_buffer #(
          .BITS(DEPTH_BITS),
          .ADDRESS(ADDRESS)
      ) depth_bank (
          .clk,
          .advance(reads),
          .write(depth_write || clearing),
          .write_address(clearing ? clear_address : depth_write_address),
          .write_word(clearing ? {2'b01, {(DEPTH_BITS - 2) {1'b0}}} : depth_word),
          .read_address(state == READ ? scan_address : depth_read_address),
          .read_word(depths[l*DEPTH_BITS+:DEPTH_BITS])
      );
      tile_buffer #(
          .BITS(COLOUR_BITS),
          .ADDRESS(ADDRESS)
      ) colour_bank (
          .clk,
          .advance(reads),
          .write(colour_write || clearing),
          .write_address(clearing ? clear_address : colour_write_address),
          .write_word(clearing ? '0 : colour_word),
          .read_address(state == READ ? scan_address : colour_read_address),
          .read_word(colours[l*COLOUR_BITS+:COLOUR_BITS])
      );
      assign lane_idle[l] = !queued && lane_quiet;
      assign pixels_idle[l] = !inside1 && !inside2 && blend_quiet;
    end
  endgenerate

  assign raster_idle = setup_idle && rows_idle && &lane_idle;
  assign idle = raster_idle && &pixels_idle;
endmodule
