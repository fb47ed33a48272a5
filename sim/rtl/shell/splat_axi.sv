// The splat primitive behind the buses of a board: packets come in and pixels go out by AXI4-Stream, everything else by
// AXI4-Lite.
//
//   packets  words as `splatline_packet_encode` gives them, the first field in the lowest bits, one in each beat of 32
//            bits; with a STREAM of 64 or 128 bits two or four of them, the first lowest; `tlast` with a packet's last
//            beat
//   pixels   128 bits, row by row: red, green, blue, and the transmittance with the finished flag in bit 127; `tlast`
//            with a tile's last pixel
//
// Registers are listed in registers.json, from which `registers.py` writes splat_axi.svd and splat_axi.h.
//
// A begin waits until the tile before has ended, and packets wait until their tile has begun. An end waits until every
// packet whose first beat came before it has been drawn, and until the tile before has been read out. Without a tile
// that it could end it does nothing.
module splat_axi #(
    parameter LANES = 1,
    parameter QUEUE = 8,
    parameter SETUP_INTERVAL = 4,
    parameter ROW_INTERVAL = 1,
    parameter ADDED_BITS = 4,
    parameter WIDE_MULTIPLIERS = 4,
    parameter STREAM = 32
) (
    input logic aclk,
    input logic aresetn,
    input logic [STREAM-1:0] s_axis_packet_tdata,
    input logic s_axis_packet_tvalid,
    output logic s_axis_packet_tready,
    input logic s_axis_packet_tlast,
    output logic [127:0] m_axis_pixel_tdata,
    output logic m_axis_pixel_tvalid,
    input logic m_axis_pixel_tready,
    output logic m_axis_pixel_tlast,
    input logic [6:0] s_axil_awaddr,
    input logic [2:0] s_axil_awprot,
    input logic s_axil_awvalid,
    output logic s_axil_awready,
    input logic [31:0] s_axil_wdata,
    input logic [3:0] s_axil_wstrb,
    input logic s_axil_wvalid,
    output logic s_axil_wready,
    output logic [1:0] s_axil_bresp,
    output logic s_axil_bvalid,
    input logic s_axil_bready,
    input logic [6:0] s_axil_araddr,
    input logic [2:0] s_axil_arprot,
    input logic s_axil_arvalid,
    output logic s_axil_arready,
    output logic [31:0] s_axil_rdata,
    output logic [1:0] s_axil_rresp,
    output logic s_axil_rvalid,
    input logic s_axil_rready
);
  localparam T = splatline_pkg::TRANSMITTANCE;
  localparam SUM = splatline_pkg::SUM_BITS;
  localparam BEATS = (splatline_pkg::PACKET_BITS + STREAM - 1) / STREAM;
  localparam COUNT = $clog2(BEATS + 1);

  generate
    if (STREAM != 32 && STREAM != 64 && STREAM != 128) begin : gen_illegal
      $error("splat_axi: STREAM must be 32, 64 or 128");
    end
  endgenerate

  // Reset goes through a register: it reaches the whole primitive.
  logic rst;
  always_ff @(posedge aclk) rst <= !aresetn;

  // Packets: beats are shifted in from above, so that the first one comes to lie lowest. The next packet's first beat
  // may come in the cycle in which a packet is taken, so that four beats fit between two packets.
  logic [STREAM*BEATS-1:0] beats;
  logic [COUNT-1:0] received, place;
  logic whole, beat_moves, packet_moves, ends, wrong, skips, packet_ready, packet_valid;
  logic [31:0] packets, broken;
  assign whole = received == COUNT'(BEATS);
  assign packet_valid = whole;
  assign packet_moves = whole && packet_ready;
  assign place = packet_moves ? '0 : received;
  assign s_axis_packet_tready = (!whole || packet_ready) && !rst;
  assign beat_moves = s_axis_packet_tvalid && s_axis_packet_tready;
  assign ends = place == COUNT'(BEATS - 1);
  assign wrong = !skips && s_axis_packet_tlast != ends;
  always_ff @(posedge aclk) begin
    if (beat_moves) beats <= {s_axis_packet_tdata, beats[STREAM*BEATS-1:STREAM]};
    if (rst) begin
      received <= 0;
      packets <= 0;
      broken <= 0;
      skips <= 0;
    end else begin
      received <= place;
      // A packet of the wrong length is dropped up to its last beat.
      if (beat_moves) begin
        received <= skips || wrong ? '0 : place + 1'b1;
        skips <= (skips || wrong) && !s_axis_packet_tlast;
        if (wrong) broken <= broken + 32'd1;
      end
      if (packet_moves) packets <= packets + 32'd1;
    end
  end

  // Registers: an address and its word are taken together, an answer waits for its taker.
  logic writes, reads, begins, finishes, drawing, ends_tile, begin_ready, finish_ready, idle, raster_idle, table_valid;
  logic [31:0] first, last, alpha_max, minimum_transmittance, table_index, table_low, table_step, cycles, pixels;
  logic [63:0] least;
  logic [1:0] flags;
  logic [15:0] foreign_packets;
  assign writes = s_axil_awvalid && s_axil_wvalid && !s_axil_bvalid && !rst;
  assign reads = s_axil_arvalid && !s_axil_rvalid && !rst;
  assign {s_axil_awready, s_axil_wready, s_axil_arready} = {writes, writes, reads};
  assign {s_axil_bresp, s_axil_rresp} = 4'd0;
  // A tile is drawn, or is to be, from this very write on.
  assign ends_tile = (drawing && !finish_ready) || begins || s_axil_wdata[0];
  always_ff @(posedge aclk) begin
    table_valid <= writes && s_axil_awaddr[6:2] == 5'd11;
    if (table_valid) table_index <= table_index + 32'd1;
    if (writes) begin
      case (s_axil_awaddr[6:2])
        5'd2: first <= s_axil_wdata;
        5'd3: last <= s_axil_wdata;
        5'd4: alpha_max <= s_axil_wdata;
        5'd5: minimum_transmittance <= s_axil_wdata;
        5'd6: least[31:0] <= s_axil_wdata;
        5'd7: least[63:32] <= s_axil_wdata;
        5'd8: flags <= s_axil_wdata[1:0];
        5'd9: table_index <= s_axil_wdata;
        5'd10: table_low <= s_axil_wdata;
        5'd11: table_step <= s_axil_wdata;
        default: ;
      endcase
    end
    if (reads) begin
      case (s_axil_araddr[6:2])
        5'd0: s_axil_rdata <= {28'd0, raster_idle, idle, finishes, begins};
        5'd1: s_axil_rdata <= {28'd0, splatline_pkg::PACKET_VERSION};
        5'd2: s_axil_rdata <= first;
        5'd3: s_axil_rdata <= last;
        5'd12: s_axil_rdata <= packets;
        5'd13: s_axil_rdata <= {16'd0, foreign_packets};
        5'd14: s_axil_rdata <= broken;
        5'd15: s_axil_rdata <= pixels;
        5'd16: s_axil_rdata <= cycles;
        default: s_axil_rdata <= 32'd0;
      endcase
    end
    if (rst) begin
      s_axil_bvalid <= 0;
      s_axil_rvalid <= 0;
      begins <= 0;
      finishes <= 0;
      drawing <= 0;
      cycles <= 0;
      {first, last, alpha_max, minimum_transmittance, least, flags, table_index, table_low, table_step} <= '0;
    end else begin
      s_axil_bvalid <= writes || (s_axil_bvalid && !s_axil_bready);
      s_axil_rvalid <= reads || (s_axil_rvalid && !s_axil_rready);
      begins <= (begins && !begin_ready) || (writes && s_axil_awaddr[6:2] == 5'd0 && s_axil_wdata[0]);
      finishes <= (finishes && !finish_ready) || (writes && s_axil_awaddr[6:2] == 5'd0 && s_axil_wdata[1] && ends_tile);
      drawing <= (drawing && !finish_ready) || (begins && begin_ready);
      cycles <= cycles + 32'd1;
    end
  end

  // An end is offered when no packet is under way; `finish_ready` counts in that cycle alone.
  logic may_finish, primitive_finishes;
  assign may_finish = finishes && received == 0 && !s_axis_packet_tvalid;
  assign finish_ready = may_finish && primitive_finishes;

  splatline_pkg::rules_t rules;
  splatline_pkg::window_t tile;
  assign rules = {alpha_max[splatline_pkg::ALPHA:0], least[splatline_pkg::PEAK+splatline_pkg::WEIGHT:0], minimum_transmittance[T:0], flags};
  assign tile = {first[15:0], first[31:16], last[15:0], last[31:16]};

  // Pixels of the tile that is read out: counted, so that its last one is known.
  logic [31:0] tile_pixels, left;
  logic pixel_moves;
  logic [T+1:0] transmittance;
  logic [3*SUM-1:0] colour;
  always_ff @(posedge aclk) tile_pixels <= (32'(last[15:0]) - 32'(first[15:0])) * (32'(last[31:16]) - 32'(first[31:16]));
  assign pixel_moves = m_axis_pixel_tvalid && m_axis_pixel_tready;
  assign m_axis_pixel_tdata = {transmittance[T+1], 31'(transmittance[T:0]), 32'(colour[2*SUM+:SUM]), 32'(colour[SUM+:SUM]), 32'(colour[0+:SUM])};
  assign m_axis_pixel_tlast = left == 32'd1;
  logic [31:0] drawn_pixels;
  always_ff @(posedge aclk) begin
    // The window's registers may be written as soon as its tile has begun.
    if (begins && begin_ready) drawn_pixels <= tile_pixels;
    if (finish_ready) left <= drawn_pixels;
    else if (pixel_moves) left <= left - 32'd1;
    if (rst) pixels <= 0;
    else if (pixel_moves) pixels <= pixels + 32'd1;
  end

  splat_primitive #(
      .LANES(LANES),
      .QUEUE(QUEUE),
      .SETUP_INTERVAL(SETUP_INTERVAL),
      .ROW_INTERVAL(ROW_INTERVAL),
      .ADDED_BITS(ADDED_BITS),
      .WIDE_MULTIPLIERS(WIDE_MULTIPLIERS)
  ) splats (
      .clk(aclk),
      .rst,
      .rules,
      .table_valid,
      .table_index(table_index[splatline_pkg::TABLE:0]),
      .table_low(table_low[splatline_pkg::WEIGHT:0]),
      .table_step(table_step[splatline_pkg::STEP_BITS-1:0]),
      .tile_valid(begins),
      .tile_ready(begin_ready),
      .tile,
      .packet_valid,
      .packet_ready,
      .packet(beats[splatline_pkg::PACKET_BITS-1:0]),
      .finish_valid(may_finish),
      .finish_ready(primitive_finishes),
      .pixel_valid(m_axis_pixel_tvalid),
      .pixel_ready(m_axis_pixel_tready),
      .pixel_transmittance(transmittance),
      .pixel_colour(colour),
      .lanes_enable(1'b1),
      .raster_idle,
      .idle,
      .foreign_packets
  );

  // Every word is written whole, whoever writes.
  logic unused;
  assign unused = &{1'b0, s_axil_awprot, s_axil_arprot, s_axil_wstrb, s_axil_awaddr[1:0], s_axil_araddr[1:0], alpha_max, minimum_transmittance, least, table_index, table_low, table_step, beats};
endmodule
