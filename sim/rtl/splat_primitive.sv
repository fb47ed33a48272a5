// The hardware splat primitive: packets of splats in, a tile of finished pixels out.
//
//   packet_decode -> splat_setup -> row_generator -> run_queue -> lane -> footprint_table -> blend <-> tile_buffer
//                                                    `------------- once for every lane -------------'
//
// Lane l owns the tile's rows y with y mod LANES = l and the bank that holds them. So a pixel only ever meets one lane,
// splats keep their order at every pixel, and lanes work on different rows, where short runs leave none idle.
//
// A tile: `tile` (the window, within one aligned block of a tile's size and from its first column and row on) begins
// it; packets follow, nearest first; `finish` waits for the last pixel and for the read-out of the tile before. Then
// this tile is read out, row by row, and cleared behind, while the next one is drawn into the other buffer. After a
// reset both are cleared once.
module splat_primitive #(
    parameter LANES = 1,
    parameter QUEUE = 8,
    // Cycles between two packets, 1, 4 or 8, and between two rows, 1 or 2: how many stages share a unit.
    parameter SETUP_INTERVAL = 4,
    parameter ROW_INTERVAL = 1,
    parameter ADDED_BITS = 4,  // which opacities and shares multiply by additions, see multiply.sv
    parameter WIDE_MULTIPLIERS = 4,  // of rows' and colours' products of two wide factors: 4 or 3, see multiply_three.sv
    parameter BLOCK_WORDS = 512  // of a block RAM at its full width; 0 where a memory's bits are paid for one by one
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
    output logic [splatline_pkg::TRANSMITTANCE+1:0] pixel_transmittance,  // finished flag, UQ1.transmittance
    output logic [3*splatline_pkg::SUM_BITS-1:0] pixel_colour,  // blue, green, red, UQ5.accumulator
    // Lanes move only in cycles that follow one in which this is set: where the tile buffer shares its memory's ports.
    input logic lanes_enable,
    output logic raster_idle,  // every packet taken has reached its last pixel
    output logic idle,  // and that pixel is in the tile buffer
    output logic [15:0] foreign_packets
);
  localparam LANE_BITS = LANES == 1 ? 0 : $clog2(LANES);
  localparam COLUMN_BITS = splatline_pkg::TILE_COLUMN_BITS;
  localparam ROW_BITS = splatline_pkg::TILE_ROW_BITS;
  localparam ADDRESS = COLUMN_BITS + ROW_BITS - LANE_BITS;
  localparam TRANSMITTANCE_BITS = splatline_pkg::TRANSMITTANCE + 2;
  localparam COLOUR_BITS = 3 * splatline_pkg::SUM_BITS;
  localparam PEAK_BITS = splatline_pkg::PEAK + 4;
  localparam PAINT_BITS = 3 * splatline_pkg::COLOUR_BITS;
  // Numbers of a lane's runs, see run_paint.sv.
  localparam SLOTS = QUEUE < 8 ? 16 : 2 * QUEUE;
  localparam SLOT_BITS = $clog2(SLOTS);

  // What the circuit is not built for fails here, not in the picture. The generator of packages refuses the same widths
  // by name.
  generate
    if (WIDE_MULTIPLIERS != 3 && WIDE_MULTIPLIERS != 4) begin : gen_illegal_multipliers
      $error("WIDE_MULTIPLIERS must be 3 or 4");
    end
    if (LANES < 1 || LANES > 16 || (LANES & (LANES - 1)) != 0 || LANES >= (1 << ROW_BITS)) begin : gen_illegal_lanes
      $error("LANES must be 1, 2, 4, 8 or 16, and fewer than a tile has rows");
    end
    if (!(SETUP_INTERVAL == 1 || SETUP_INTERVAL == 4 || SETUP_INTERVAL == 8) || ROW_INTERVAL < 1 || ROW_INTERVAL > 2 || ROW_INTERVAL > SETUP_INTERVAL) begin : gen_illegal_intervals
      $error("SETUP_INTERVAL must be 1, 4 or 8, ROW_INTERVAL 1, or 2 where SETUP_INTERVAL is not 1");
    end
    if (QUEUE < 2 || QUEUE > 256 || (QUEUE & (QUEUE - 1)) != 0) begin : gen_illegal_queue
      $error("QUEUE must be a power of two from 2 to 256");
    end
    if (COLUMN_BITS < 1 || COLUMN_BITS != splatline_pkg::BLOCK_BITS) begin : gen_illegal_columns
      $error("a tile must have as many columns as a seed's block, and 2 or more");
    end
    // A packet's exponent, those of two products with a distance of at most 64 bits and their roundings, a shift of at
    // most 63, a unit.
    if ((1 << (splatline_pkg::EXPONENT - 1)) < 512 + 4 * 64 + 63 + splatline_pkg::VERTICAL + splatline_pkg::GUARD) begin : gen_illegal_exponents
      $error("EXPONENT is too short for the exponents of setup and rows");
    end
    if (ROW_BITS < 1 || ROW_BITS > 8 || ADDRESS < 1) begin : gen_illegal_rows
      $error("a tile must have from 2 to 256 rows");
    end
    if (splatline_pkg::RADIAL > 27 || splatline_pkg::MANTISSA > 31) begin : gen_illegal_radial
      $error("RADIAL must be at most 27 (a lane has 32 bits), MANTISSA at most 31");
    end
    if (splatline_pkg::INTERPOLATION < 1 || splatline_pkg::TABLE + splatline_pkg::INTERPOLATION > splatline_pkg::RADIAL + 4) begin : gen_illegal_table
      $error("INTERPOLATION must be at least 1, and TABLE and INTERPOLATION together at most RADIAL + 4");
    end
    if (splatline_pkg::PEAK + splatline_pkg::WEIGHT <= splatline_pkg::ALPHA || splatline_pkg::TRANSMITTANCE + splatline_pkg::COLOUR <= splatline_pkg::ACCUMULATOR) begin : gen_illegal_products
      $error("PEAK + WEIGHT must exceed ALPHA, and TRANSMITTANCE + COLOUR must exceed ACCUMULATOR");
    end
  endgenerate

  typedef enum logic [1:0] {
    CLEAR,
    IDLE,
    DRAW
  } state_t;
  state_t state;
  splatline_pkg::window_t window;
  // The buffer that is drawn into; the other one is read out, or clear.
  logic side, side_next, reading;
  // Buffers that belong to the scan: the one that is not drawn into, or both. Each lane has registers of its own for
  // its banks.
  logic [1:0] scanned, scanned_next;
  // The lanes may move in the next cycle.
  logic may_move;

  assign tile_ready = state == IDLE;
  // A packet offered together with `finish` still belongs to this tile: `finish` waits.
  assign finish_ready = state == DRAW && idle && !packet_valid && !reading;

  // Packets to runs.
  logic footprint_valid, footprint_ready, splat_valid, splat_ready, slot_valid, slot_ready, slot_has_run, next_has_run, setup_idle, rows_idle;
  logic [ROW_BITS-1:0] next_lane;
  splatline_pkg::footprint_t footprint;
  splatline_pkg::start_t start;
  splatline_pkg::shape_t shape;
  splatline_pkg::run_t run;
  splatline_pkg::paint_t paint;
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
  splat_setup #(
      .INTERVAL(SETUP_INTERVAL)
  ) setup (
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
  row_generator #(
      .LANE_BITS(LANE_BITS),
      .INTERVAL(ROW_INTERVAL),
      .WIDE_MULTIPLIERS(WIDE_MULTIPLIERS)
  ) rows (
      .clk,
      .rst,
      .splat_valid,
      .splat_ready,
      .start,
      .shape,
      .slot_valid,
      .slot_ready,
      .slot_has_run,
      .next_has_run,
      .next_lane,
      .run,
      .paint,
      .idle(rows_idle)
  );

  // The scan that reads out and clears behind: row and column within the block. After a reset it clears all.
  logic [ROW_BITS-1:0] scan_row, last_row;
  logic [COLUMN_BITS-1:0] scan_column, first_column, last_column;
  logic [ADDRESS-1:0] clear_address;
  logic scan_last_column, scan_last_row, scan_valid, word_valid, scan_moves, window_has_pixels, finishes;
  assign window_has_pixels = window.first_column < window.end_column && window.first_row < window.end_row;
  assign scan_last_column = scan_column == last_column;
  assign scan_last_row = scan_row == last_row;
  assign scan_moves = !pixel_valid || pixel_ready;
  assign finishes = finish_valid && finish_ready;
  assign reading = scan_valid || word_valid || pixel_valid;

  assign may_move = lanes_enable && state == DRAW;
  always_comb begin
    if (rst) scanned_next = 2'b11;
    else if (state == CLEAR) scanned_next = &clear_address ? 2'b10 : 2'b11;
    else scanned_next = finishes ? ~scanned : scanned;
  end
  // Each lane has a register of its own for the side, too.
  assign side_next = !rst && side != finishes;
  always_ff @(posedge clk) {scanned, side} <= {scanned_next, side_next};

  always_ff @(posedge clk) begin
    if (rst) begin
      state <= CLEAR;
      clear_address <= 0;
      pixel_valid <= 0;
      word_valid <= 0;
      scan_valid <= 0;
    end else begin
      case (state)
        CLEAR: begin
          clear_address <= clear_address + 1'b1;
          if (&clear_address) state <= IDLE;
        end
        IDLE:
        if (tile_valid) begin
          state <= DRAW;
          window <= tile;
        end
        DRAW:
        if (finishes) begin
          state <= IDLE;
        end
        default: state <= CLEAR;
      endcase
      if (finishes) begin
        scan_valid <= window_has_pixels;
        scan_row <= ROW_BITS'(window.first_row);
        scan_column <= COLUMN_BITS'(window.first_column);
        first_column <= COLUMN_BITS'(window.first_column);
        last_column <= COLUMN_BITS'(window.end_column - 16'd1);
        last_row <= ROW_BITS'(window.end_row - 16'd1);
      end else if (scan_moves) begin
        pixel_valid <= word_valid;
        word_valid <= scan_valid;
        if (scan_last_column) begin
          scan_column <= first_column;
          scan_row <= scan_row + 1'b1;
        end else scan_column <= scan_column + 1'b1;
        if (scan_last_column && scan_last_row) scan_valid <= 0;
      end
    end
  end

  // The lanes.
  logic [LANES-1:0] queue_ready, queue_ready_next, lane_idle, pixels_idle;
  // Whether the slot leaves is decided in the cycle before: it reaches the enables of all the queue's memories.
  always_ff @(posedge clk) slot_ready <= !next_has_run || 1'(queue_ready_next >> next_lane);
  // What the lane that owns the row being read out gives: transmittance and colour. The others give 0, so that joining
  // them costs less than choosing.
  localparam WORD_BITS = TRANSMITTANCE_BITS + COLOUR_BITS;
  logic [LANES*WORD_BITS-1:0] words;
  logic [WORD_BITS-1:0] read_word;
  always_comb begin
    read_word = '0;
    for (int i = 0; i < LANES; i = i + 1) read_word = read_word | words[i*WORD_BITS+:WORD_BITS];
  end
  logic [ROW_BITS-1:0] word_row;
  always_ff @(posedge clk) if (scan_moves) word_row <= scan_row;

  genvar l;
  assign {pixel_transmittance, pixel_colour} = read_word;
  generate
    for (l = 0; l < LANES; l = l + 1) begin : gen_lane
      logic mine, queued, taken, empty, inside0, inside1, inside2, inside3, inside4, inside5, lane_quiet, blend_quiet;
      // A register for each part of each lane, kept although all say the same: one alone would have to reach thousands
      // of others.
      logic moves, table_moves, blend_moves, bank_moves, drawn;
      logic [1:0] banks_scanned;
      splatline_pkg::run_t queued_run;
      logic [splatline_pkg::RADIAL+3:0] radial;
      logic [ROW_BITS+COLUMN_BITS-1:0] place;
      logic [ADDRESS-1:0] address0, address5;
      logic queue_takes;
      logic [SLOT_BITS-1:0] in_slot, queued_slot, slot0, slot4, slot5, colour_slot;
      logic [PEAK_BITS-1:0] peak5;
      logic [PAINT_BITS-1:0] colour_found;
      logic [53:0] colour_sums;
      logic [splatline_pkg::WEIGHT:0] weight;

      if (LANES == 1) begin : gen_all_rows
        assign mine = 1'b1;
        assign address0 = place;
      end else begin : gen_own_rows
        assign mine = run.row[LANE_BITS-1:0] == l[LANE_BITS-1:0];
        assign address0 = {place[ROW_BITS+COLUMN_BITS-1:COLUMN_BITS+LANE_BITS], place[COLUMN_BITS-1:0]};
      end

      (* keep *)
      always_ff @(posedge clk) begin
        if (rst) begin
          moves <= 0;
          table_moves <= 0;
          blend_moves <= 0;
          bank_moves <= 0;
        end else begin
          moves <= may_move;
          table_moves <= may_move;
          blend_moves <= may_move;
          bank_moves <= may_move;
        end
        banks_scanned <= scanned_next;
        drawn <= side_next;
      end

      assign queue_takes = slot_valid && slot_has_run && mine;
      run_queue #(
          .DEPTH(QUEUE),
          .SLOTS(SLOTS)
      ) queue (
          .clk,
          .rst,
          .in_valid(queue_takes),
          .in_ready(queue_ready[l]),
          .ready_next(queue_ready_next[l]),
          .in_run(run),
          .in_slot,
          .out_valid(queued),
          .out_ready(taken),
          .out_run(queued_run),
          .out_slot(queued_slot),
          .empty
      );
      run_paint #(
          .SLOTS(SLOTS)
      ) paints (
          .clk,
          .write(queue_takes && queue_ready[l]),
          .write_slot(in_slot),
          .paint,
          .peak_advance(table_moves),
          .peak_slot(slot4),
          .peak(peak5),
          .colour_advance(blend_moves),
          .colour_slot,
          .colour(colour_found),
          .colour_sums
      );
      lane #(
          .SLOT_BITS(SLOT_BITS)
      ) pixels (
          .clk,
          .rst,
          .advance(moves),
          .run_valid(queued),
          .run_ready(taken),
          .run(queued_run),
          .run_slot(queued_slot),
          .pixel_valid(inside0),
          .radial,
          .address(place),
          .slot(slot0),
          .idle(lane_quiet)
      );
      footprint_table kernel (
          .clk,
          .advance(table_moves),
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
          inside3 <= 0;
          inside4 <= 0;
          inside5 <= 0;
        end else if (table_moves) begin
          inside1 <= inside0;
          inside2 <= inside1;
          inside3 <= inside2;
          inside4 <= inside3;
          inside5 <= inside4;
        end
      end
      delay #(.BITS(ADDRESS), .STAGES(5)) hold_address (.clk, .rst, .advance(table_moves), .in(address0), .out(address5));
      delay #(.BITS(SLOT_BITS), .STAGES(4)) hold_slot4 (.clk, .rst, .advance(table_moves), .in(slot0), .out(slot4));
      delay #(.BITS(SLOT_BITS), .STAGES(1)) hold_slot5 (.clk, .rst, .advance(table_moves), .in(slot4), .out(slot5));

      logic transmittance_write, colour_write;
      logic [ADDRESS-1:0] transmittance_read_address, transmittance_write_address, colour_read_address, colour_write_address;
      logic [TRANSMITTANCE_BITS-1:0] transmittance_word;
      logic [COLOUR_BITS-1:0] colour_word;
      logic [2*TRANSMITTANCE_BITS-1:0] transmittances;
      logic [COLOUR_BITS-1:0] colour_read;
      blend #(
          .ADDRESS(ADDRESS),
          .SLOT_BITS(SLOT_BITS),
          .ADDED_BITS(ADDED_BITS),
          .WIDE_MULTIPLIERS(WIDE_MULTIPLIERS)
      ) over (
          .clk,
          .rst,
          .advance(blend_moves),
          .rules,
          .pixel_valid(inside5),
          .pixel_address(address5),
          .weight,
          .peak(peak5),
          .pixel_slot(slot5),
          .colour_slot,
          .colour11(colour_found),
          .colour_sums11(colour_sums),
          .transmittance_read_address,
          .transmittance_read(drawn ? transmittances[TRANSMITTANCE_BITS+:TRANSMITTANCE_BITS] : transmittances[0+:TRANSMITTANCE_BITS]),
          .transmittance_write,
          .transmittance_write_address,
          .transmittance_word,
          .colour_read_address,
          .colour_read,
          .colour_write,
          .colour_write_address,
          .colour_word,
          .idle(blend_quiet)
      );
      // Where nothing lies in front of the background, there is no colour, and the memory's is of an older tile.
      logic [TRANSMITTANCE_BITS-1:0] scanned_transmittance;
      logic [COLOUR_BITS-1:0] scanned_colour;
      logic coloured;
      assign scanned_transmittance = drawn ? transmittances[0+:TRANSMITTANCE_BITS] : transmittances[TRANSMITTANCE_BITS+:TRANSMITTANCE_BITS];
      assign coloured = mine_in_word && !scanned_transmittance[splatline_pkg::TRANSMITTANCE];
      assign words[l*WORD_BITS+:WORD_BITS] = {mine_in_word ? scanned_transmittance : '0, coloured ? scanned_colour : '0};

      // The lane owns the bank of the side that is drawn, the scan the other one; it clears what it has read.
      logic clears, mine_in_scan, mine_in_word;
      logic [ADDRESS-1:0] scan_address;
      if (LANES == 1) begin : gen_scan_all
        assign scan_address = {scan_row, scan_column};
        assign mine_in_scan = 1'b1;
        assign mine_in_word = 1'b1;
      end else begin : gen_scan_own
        assign scan_address = {scan_row[ROW_BITS-1:LANE_BITS], scan_column};
        assign mine_in_scan = scan_row[LANE_BITS-1:0] == l[LANE_BITS-1:0];
        always_ff @(posedge clk) if (scan_moves) mine_in_word <= word_row[LANE_BITS-1:0] == l[LANE_BITS-1:0];
      end
      assign clears = state == CLEAR || (scan_valid && scan_moves && mine_in_scan);
      genvar b;
      for (b = 0; b < 2; b = b + 1) begin : gen_side
        tile_buffer #(
            .BITS(TRANSMITTANCE_BITS),
            .ADDRESS(ADDRESS),
            .CLEAR({2'b01, {(TRANSMITTANCE_BITS - 2) {1'b0}}})
        ) transmittance_bank (
            .clk,
            .clears(banks_scanned[b]),
            .clear(clears),
            .clear_address(state == CLEAR ? clear_address : scan_address),
            .advance(bank_moves),
            .write(transmittance_write),
            .write_address(transmittance_write_address),
            .write_word(transmittance_word),
            .read(banks_scanned[b] ? scan_moves : bank_moves),
            .read_address(banks_scanned[b] ? scan_address : transmittance_read_address),
            .read_word(transmittances[b*TRANSMITTANCE_BITS+:TRANSMITTANCE_BITS])
        );
      end
      tile_colours #(
          .BITS(COLOUR_BITS),
          .ADDRESS(ADDRESS),
          .BLOCK_WORDS(BLOCK_WORDS)
      ) colour_banks (
          .clk,
          .drawn,
          .advance(bank_moves),
          .write(colour_write),
          .write_address(colour_write_address),
          .write_word(colour_word),
          .read_address(colour_read_address),
          .read_word(colour_read),
          .scan(scan_moves),
          .scan_address,
          .scan_word(scanned_colour)
      );
      assign lane_idle[l] = empty && lane_quiet;
      assign pixels_idle[l] = !inside1 && !inside2 && !inside3 && !inside4 && !inside5 && blend_quiet;
    end
  endgenerate

  // Registered, so that they lie on nobody's way: set in the cycle after the last of them has come to rest.
  logic all_idle, packet_taken;
  assign all_idle = setup_idle && rows_idle && &lane_idle;
  assign packet_taken = footprint_valid && footprint_ready;
  always_ff @(posedge clk) begin
    raster_idle <= rst || (all_idle && !packet_taken);
    idle <= rst || (all_idle && !packet_taken && &pixels_idle);
  end

`ifdef FORMAL
`include "formal/splat_primitive_properties.svh"
`endif
endmodule
