// The whole machine: a scene's records in memory, a frame's pixels in memory.
//
//   records -> setup_unit -> packets -> memory
//                        `-> splat_order <-> memory -> lists -> memory
//   lists -> packet_fetch <- packets; -> splat_primitive -> frame <- tile_background
//
// With HARMONICS, the number of multipliers of their unit, splats have colours of harmonics instead of their records'.
// The program of setup then is one with directions, and the harmonics of splats that are seen are read in the first
// phase:
//
//   directions of setup_unit, harmonics -> harmonics_colours -> packets
//
// Camera and rules are written beforehand (`constant_*`, `rules`, `table_*`), and where everything lies is held steady
// while a frame is drawn. Three phases, one after the other: no tile can be drawn in the order of depths before the
// last splat is binned. One port to memory, which reads and writes words of 16 bytes at the same time; words that are
// read come in the order in which they were asked for, and `settled` says that none that was written is still on its
// way.
//
// A record has 5 words, a splat's harmonics one for the base and one for each coefficient (3 x Q3.28, red lowest), a
// packet as many as its bits need, a splat to be sorted one, four list entries one, a pixel one (transmittance with the
// flag of finished pixels, red, green, blue, 32 bits each). Pixels follow each other tile by tile, each row by row.
module splat_machine #(
    parameter CORES = 4,
    parameter LANES = 1,
    parameter DIGIT = 8,
    parameter TILE_BITS = 12,
    parameter BLOCK_WORDS = 512,  // see splat_primitive.sv
    parameter HARMONICS = 0
) (
    input logic clk,
    input logic rst,
    input logic constant_valid,
    input logic [6:0] constant_index,
    input logic [63:0] constant_value,
    input logic [17:0] constant_exponent,
    input splatline_pkg::rules_t rules,
    input logic table_valid,
    input logic [splatline_pkg::TABLE:0] table_index,
    input logic [splatline_pkg::WEIGHT:0] table_low,
    input logic [splatline_pkg::STEP_BITS-1:0] table_step,
    // A frame: where everything lies, in words.
    input logic begins,
    input logic [31:0] records,
    input logic [31:0] base_records,
    input logic [31:0] base_harmonics,
    input logic [2:0] degree,
    input logic [31:0] base_packets,
    input logic [31:0] base_a,
    input logic [31:0] base_b,
    input logic [31:0] base_lists,
    input logic [31:0] base_frame,
    input logic [23:0] most,  // entries for which the lists have room
    input logic [15:0] columns,
    input logic [15:0] rows,
    output logic [1:0] phase,  // 0: none; 1: geometry, 2: order, 3: raster
    output logic full,  // the lists had no room: the frame was not drawn
    output logic [23:0] visible,
    output logic [23:0] entries,
    // The memory.
    output logic read_valid,
    input logic read_ready,
    output logic [31:0] read_address,
    input logic word_valid,
    input logic [127:0] word,
    output logic write_valid,
    input logic write_ready,
    output logic [31:0] write_address,
    output logic [127:0] write_word,
    output logic [3:0] write_strobe,
    input logic settled
);
  localparam RECORD = 5;
  localparam RECORD_BITS = 582;  // of record_t, which lint compares
  localparam PACKET = (splatline_pkg::PACKET_BITS + 127) / 128;
  localparam COLUMN_BITS = splatline_pkg::TILE_COLUMN_BITS;
  localparam ROW_BITS = splatline_pkg::TILE_ROW_BITS;
  localparam SUM = splatline_pkg::SUM_BITS;

  localparam READERS = HARMONICS == 0 ? 3 : 4;
  logic [127:0] coming;  // word that was read, to whoever asked for it

  generate
    if (HARMONICS != 0 && !splatline_setup_pkg::DIRECTS) begin : gen_illegal
      $error("splat_machine: HARMONICS needs a program of setup with directions");
    end
  endgenerate

  typedef enum logic [2:0] {
    IDLE,
    GEOMETRY,
    ORDER,
    TILE,
    DRAW,
    FINISH,
    DRAIN
  } state_t;
  state_t state;

  // The screen in tiles.
  logic [11:0] tile_columns, tile_rows;
  logic [TILE_BITS:0] tiles;
  assign tile_columns = 12'((17'(columns) + 17'((1 << COLUMN_BITS) - 1)) >> COLUMN_BITS);
  assign tile_rows = 12'((17'(rows) + 17'((1 << ROW_BITS) - 1)) >> ROW_BITS);
  always_ff @(posedge clk) tiles <= (TILE_BITS + 1)'(tile_columns * tile_rows);

  // What is read in one piece: the records, and later the lists.
  logic stream_begins, stream_read, stream_comes, stream_valid, stream_ready, read_ready_stream;
  logic [31:0] stream_address;
  logic [127:0] stream_word;
  logic raster_begins, harmonics_turn;
  assign stream_begins = (state == IDLE && begins) || raster_begins;
  memory_stream stream (
      .clk,
      .rst,
      .begins(stream_begins),
      .first(raster_begins ? base_lists : base_records),
      .count(raster_begins ? (32'(entries) + 32'd3) >> 2 : splatline_math::times(records, 4'(RECORD))),
      .none(raster_begins ? entries == 0 : records == 0),
      .read_valid(stream_read),
      .read_ready(read_ready_stream && !harmonics_turn),
      .read_address(stream_address),
      .requested(),
      .word_valid(stream_comes),
      .word(coming),
      .out_valid(stream_valid),
      .out_ready(stream_ready),
      .out(stream_word)
  );

  // Records to packets.
  logic record_valid, record_ready, setup_valid, setup_ready, list_ready;
  logic [2:0] gathered, cull;
  logic [128*RECORD-1:0] record_words;
  logic [47:0] depth;
  splatline_pkg::footprint_t footprint;
  logic direction_valid, direction_seen;
  logic [95:0] direction;
  // The whole record, so that whether it is taken need not reach the stream: its words come in fewer cycles than lie
  // between two records.
  assign record_valid = gathered == 3'(RECORD);
  assign stream_ready = state == GEOMETRY ? !record_valid : list_ready;
  always_ff @(posedge clk) begin
    if (state == GEOMETRY && stream_valid && stream_ready) begin
      gathered <= gathered + 1'b1;
      record_words <= {stream_word, record_words[128*RECORD-1:128]};
    end
    if (rst || (record_valid && record_ready)) gathered <= 0;
  end
  setup_unit #(
      .CORES(CORES)
  ) setup (
      .clk,
      .rst,
      .constant_valid,
      .constant_index,
      .constant_value,
      .constant_exponent,
      .record_valid,
      .record_ready,
      .record(record_words[RECORD_BITS-1:0]),
      .packet_valid(setup_valid),
      .packet_ready(setup_ready),
      .cull,
      .depth,
      .packet(footprint),
      .direction_valid,
      .direction_seen,
      .direction
  );

  // Colours come after a while; packets wait for them in their queue.
  logic harmonics_read, harmonics_comes, read_ready_harmonics, coloured;
  logic [2:0] harmonics_owed;
  logic [31:0] harmonics_address;
  splatline_pkg::footprint_t shown;
  generate
    if (HARMONICS != 0) begin : gen_harmonics
      logic [3*splatline_pkg::COLOUR_BITS-1:0] colour;
      harmonics_colours #(
          .MULTIPLIERS(HARMONICS)
      ) harmonics (
          .clk,
          .rst,
          .begins(state == IDLE && begins),
          .base(base_harmonics),
          .degree,
          .direction_valid,
          .direction_seen,
          .direction,
          .read_valid(harmonics_read),
          .read_ready(read_ready_harmonics),
          .read_address(harmonics_address),
          .word_valid(harmonics_comes),
          .word(coming[95:0]),
          .colour_valid(coloured),
          .colour_ready(setup_valid && setup_ready && cull == 0),
          .colour
      );
      always_comb begin
        shown = footprint;
        {shown.blue, shown.green, shown.red} = colour;
      end
    end else begin : gen_no_harmonics
      assign harmonics_read = 0;
      assign harmonics_address = 0;
      assign coloured = 1;
      assign shown = footprint;
    end
  endgenerate

  // Packets to memory, word by word, and what is sorted of them to the sorter. A packet's place is its number's, so
  // that culled ones leave theirs free.
  logic [31:0] number, packet_address;
  logic [3:0] step;
  logic stores, stored, sorts, sort_ready, store_ready;
  logic [128*PACKET-1:0] packet_words;
  logic [127:0] sort_word;
  assign packet_words = (128 * PACKET)'(shown);
  assign stores = state == GEOMETRY && setup_valid && coloured && cull == 0 && !stored;
  // Only packets that are seen come so far.
  assign sorts = state == GEOMETRY && setup_valid && stored;
  assign setup_ready = state == GEOMETRY && (cull != 0 || (sorts && sort_ready));
  function automatic logic [11:0] tile_of(input logic [15:0] place, input int bits);
    tile_of = 12'(place >> bits);
  endfunction
  assign sort_word = {
    tile_of(footprint.end_row - 16'd1, ROW_BITS),
    tile_of(footprint.end_column - 16'd1, COLUMN_BITS),
    tile_of(footprint.first_row, ROW_BITS),
    tile_of(footprint.first_column, COLUMN_BITS),
    number,
    depth
  };
  always_ff @(posedge clk) begin
    if (stores && store_ready) begin
      step <= step + 1'b1;
      stored <= step == 4'(PACKET - 1);
    end
    if (setup_valid && setup_ready) begin
      {step, stored} <= 0;
      number <= number + 1'b1;
      packet_address <= packet_address + 32'(PACKET);
    end
    if (state == IDLE) begin
      {number, step, stored} <= 0;
      packet_address <= base_packets;
    end
  end

  // Order and lists.
  logic order_done, order_read, order_comes, order_write, read_ready_order, write_ready_order;
  logic [31:0] order_address, order_write_address;
  logic [127:0] order_word;
  logic [3:0] order_strobe;
  logic [TILE_BITS-1:0] end_tile;
  logic [23:0] end_place;  // where the list of `end_tile` ended that was held out two cycles before
  splat_order #(
      .DIGIT(DIGIT),
      .TILE_BITS(TILE_BITS)
  ) order (
      .clk,
      .rst,
      .begins(state == IDLE && begins),
      .base_a,
      .base_b,
      .base_lists,
      .tile_columns,
      .tiles,
      .most,
      .in_valid(sorts),
      .in_ready(sort_ready),
      .in(sort_word),
      .ends(state == ORDER),
      .read_valid(order_read),
      .read_ready(read_ready_order),
      .read_address(order_address),
      .word_valid(order_comes),
      .word(coming),
      .write_valid(order_write),
      .write_ready(write_ready_order),
      .write_address(order_write_address),
      .write_word(order_word),
      .write_strobe(order_strobe),
      .settled(rests),
      .done(order_done),
      .full,
      .splats(visible),
      .entries,
      .sorted(),
      .end_tile,
      .end_place
  );

  // Lists to packets, packets to pixels.
  logic fetch_read, fetch_comes, read_ready_fetch, packet_next, packet_ready;
  logic [31:0] fetch_address;
  logic [128*PACKET-1:0] packet;
  assign raster_begins = state == ORDER && order_done && !full;
  packet_fetch #(
      .WORDS(PACKET),
      .PLACES(256)
  ) fetch (
      .clk,
      .rst,
      .begins(raster_begins),
      .base(base_packets),
      .entries(32'(entries)),
      .list_valid(stream_valid && state != GEOMETRY),
      .list_ready,
      .list(stream_word),
      .read_valid(fetch_read),
      .read_ready(read_ready_fetch),
      .read_address(fetch_address),
      .word_valid(fetch_comes),
      .word(coming),
      .packet_next,
      .packet_ready,
      .packet
  );

  // Tile after tile of those that have splats. The next one is looked for while one is drawn, the others' background is
  // written meanwhile.
  logic found, finder_request, background_valid, background_ready;
  logic [TILE_BITS:0] found_tile, turn, drawn_tile;
  logic [TILE_BITS-1:0] background_tile;
  logic [31:0] found_first, drawn_first, background_place;
  logic [23:0] found_entries;
  logic tile_ready, primitive_ready, finish_ready, drawn_valid, drawn_ready, pixel_valid;
  splatline_pkg::window_t window;
  assign end_tile = finder_request ? found_tile[TILE_BITS-1:0] : background_tile;
  assign turn = state == DRAW || state == FINISH ? drawn_tile : found_tile;
  tile_finder #(
      .TILE_BITS(TILE_BITS)
  ) drawn (
      .clk,
      .rst,
      .begins(raster_begins),
      .columns,
      .rows,
      .tiles,
      .request(finder_request),
      .granted(1'b1),
      .end_place,
      .tile(found_tile),
      .valid(found),
      .ready(state == TILE && tile_ready),
      .window,
      .first(found_first),
      .entries(found_entries)
  );
  tile_background #(
      .TILE_BITS(TILE_BITS)
  ) background (
      .clk,
      .rst,
      .begins(raster_begins),
      .columns,
      .rows,
      .tiles,
      .turn,
      .granted(!finder_request),
      .end_tile(background_tile),
      .end_place,
      .pixel_valid(background_valid),
      .pixel_ready(background_ready),
      .place(background_place)
  );

  localparam PIXEL = splatline_pkg::TRANSMITTANCE + 2 + 3 * SUM;
  logic [PIXEL-1:0] drawn_pixel;
  logic [splatline_pkg::TRANSMITTANCE+1:0] transmittance;
  logic [3*SUM-1:0] colour;
  logic [23:0] left;
  logic finish_valid;
  assign finish_valid = state == FINISH && !pixel_valid;
  // A tile that was found has splats, and its last one ends the state: none of the next tile's comes through.
  assign packet_ready = state == DRAW && primitive_ready;
  // Whether the primitive is offered a packet has a register of its own: a tile's end waits for it, and goes on to all
  // lanes.
  logic offered;
  always_ff @(posedge clk) offered <= packet_next && (state == DRAW || (state == TILE && found && tile_ready));
  splat_primitive #(
      .LANES(LANES),
      .BLOCK_WORDS(BLOCK_WORDS)
  ) raster (
      .clk,
      .rst,
      .rules,
      .table_valid,
      .table_index,
      .table_low,
      .table_step,
      .tile_valid(state == TILE && found),
      .tile_ready,
      .tile(window),
      .packet_valid(offered),
      .packet_ready(primitive_ready),
      .packet(packet[splatline_pkg::PACKET_BITS-1:0]),
      .finish_valid,
      .finish_ready,
      .pixel_valid(drawn_valid),
      .pixel_ready(drawn_ready),
      .pixel_transmittance(drawn_pixel[PIXEL-1:3*SUM]),
      .pixel_colour(drawn_pixel[3*SUM-1:0]),
      .lanes_enable(1'b1),
      .raster_idle(),
      .idle(),
      .foreign_packets()
  );

  // Whether the port takes a pixel does not reach the lanes' memories in the same cycle.
  register_slice #(
      .BITS(PIXEL)
  ) drawn_pixels (
      .clk,
      .rst,
      .in_valid(drawn_valid),
      .in_ready(drawn_ready),
      .ready_next(),
      .in(drawn_pixel),
      .out_valid(pixel_valid),
      .out_ready(writes_ready),
      .out({transmittance, colour})
  );

  logic [31:0] pixels, pixels_left;
  assign phase = state == IDLE ? 2'd0 : state == GEOMETRY ? 2'd1 : state == ORDER ? 2'd2 : 2'd3;

  always_ff @(posedge clk) begin
    case (state)
      IDLE: if (begins) state <= GEOMETRY;
      GEOMETRY: if (number == records) state <= ORDER;
      ORDER: begin
        if (order_done) state <= full ? IDLE : TILE;
        pixels_left <= columns * rows;
      end
      TILE: begin
        if (found && tile_ready) state <= DRAW;
        if (found_tile == tiles) state <= DRAIN;
        left <= found_entries;
        drawn_tile <= found_tile;
        drawn_first <= found_first;
      end
      DRAW:
      if (offered && packet_ready) begin
        left <= left - 1'b1;
        if (left == 1) state <= FINISH;
      end
      // The tile before has been read out and is on its way to the memory.
      FINISH:
      if (finish_valid && finish_ready) begin
        state <= TILE;
        pixels <= drawn_first;
      end
      DRAIN: if (pixels_left == 0 && rests) state <= IDLE;
      default: ;
    endcase
    if (pixel_valid && writes_ready) pixels <= pixels + 1'b1;
    if ((pixel_valid || background_valid) && writes_ready) pixels_left <= pixels_left - 1'b1;
    if (rst) state <= IDLE;
  end

  // The port. What is chosen stands in a register or a queue: neither the choice nor sums in front of it add to the
  // memory's way.
  logic [READERS-1:0] comes, readers, readers_ready;
  logic [32*READERS-1:0] reader_addresses;
  logic next_read_valid, next_read_ready;
  logic [31:0] next_read_address;
  // Harmonics come last, and a word of records waits for three of theirs: behind a slow memory setup would run empty
  // without records, and harmonics would begin too late.
  assign harmonics_turn = harmonics_owed[0] && harmonics_read;
  always_ff @(posedge clk) begin
    if (harmonics_read && read_ready_harmonics) harmonics_owed <= harmonics_owed >> 1;
    else if (stream_read && read_ready_stream) harmonics_owed <= 3'b111;
    if (rst) harmonics_owed <= 0;
  end
  assign readers = READERS'({harmonics_read, order_read, stream_read && !harmonics_turn, fetch_read});
  assign reader_addresses = (32 * READERS)'({harmonics_address, order_address, stream_address, fetch_address});
  assign {read_ready_harmonics, read_ready_order, read_ready_stream, read_ready_fetch} = 4'(readers_ready);
  assign {harmonics_comes, order_comes, stream_comes, fetch_comes} = 4'(comes);
  read_arbiter #(
      .UNITS(READERS),
      .DEPTH(9)
  ) reads (
      .clk,
      .rst,
      .valid(readers),
      .ready(readers_ready),
      .address(reader_addresses),
      .comes,
      .coming,
      .read_valid(next_read_valid),
      .read_ready(next_read_ready),
      .read_address(next_read_address),
      .word_valid,
      .word
  );
  assign next_read_ready = !read_valid || read_ready;
  always_ff @(posedge clk) begin
    if (next_read_ready) {read_valid, read_address} <= {next_read_valid, next_read_address};
    if (rst) read_valid <= 0;
  end

  logic [31:0] transmittance_word;
  assign transmittance_word = {transmittance[splatline_pkg::TRANSMITTANCE+1], 31'(transmittance[splatline_pkg::TRANSMITTANCE:0])};
  logic writes, writes_ready, writes_ready_next, rests;
  logic [31:0] chosen_address;
  logic [127:0] chosen_word;
  logic [3:0] chosen_strobe;
  assign background_ready = writes_ready && !pixel_valid;
  assign store_ready = writes_ready;
  // The sorter writes a splat when its packet's words have been stored. All of it moves by this register, kept although
  // it says what `writes_ready` does.
  (* keep *)
  always_ff @(posedge clk) write_ready_order <= writes_ready_next;
  assign writes = pixel_valid || background_valid || stores || order_write;
  // The phase says whose word it may be, not whether there is one: that is known later.
  logic paints;
  assign paints = state != GEOMETRY && state != ORDER;
  always_comb begin
    chosen_address = order_write_address;
    chosen_word = order_word;
    chosen_strobe = order_strobe;
    if (stores) begin
      chosen_address = packet_address + 32'(step);
      chosen_word = packet_words[128*step+:128];
      chosen_strobe = 4'hf;
    end
    if (paints) begin
      chosen_address = base_frame + (pixel_valid ? pixels : background_place);
      chosen_word = 128'd1 << splatline_pkg::TRANSMITTANCE;
      chosen_strobe = 4'hf;
      if (pixel_valid) chosen_word = {32'(colour[2*SUM+:SUM]), 32'(colour[SUM+:SUM]), 32'(colour[0+:SUM]), transmittance_word};
    end
  end
  assign rests = settled && !write_valid;
  register_slice #(
      .BITS(164)
  ) writing (
      .clk,
      .rst,
      .in_valid(writes),
      .in_ready(writes_ready),
      .ready_next(writes_ready_next),
      .in({chosen_strobe, chosen_address, chosen_word}),
      .out_valid(write_valid),
      .out_ready(write_ready),
      .out({write_strobe, write_address, write_word})
  );
endmodule
