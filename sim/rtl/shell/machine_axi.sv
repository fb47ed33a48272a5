// The whole machine behind the buses of a board: registers by AXI4-Lite, its memory by AXI4 with 128 bits.
//
// Registers are listed in machine.json, from which `registers.py` writes machine_axi.svd and machine_axi.h. Words for
// camera and rules are those that `rtl -- frame` writes for a scene, by these names.
//
// Addresses in registers are the machine's, in words of 16 bytes. Each word that it reads or writes is a transfer of
// its own. Many are on their way at once, all with the same ID, so that answers come in order. A word that is read
// always finds its place. What was written counts as settled when its response has come: only then does the machine
// read it. A reset does not call back what is on its way: the memory's side is reset with it, or has ended all
// transfers.
module machine_axi #(
    parameter CORES = 4,
    parameter LANES = 1,
    parameter HARMONICS = 0,
    parameter ADDRESS = 32  // bits of a byte's address in the memory, up to 36
) (
    input logic aclk,
    input logic aresetn,
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
    input logic s_axil_rready,
    output logic [0:0] m_axi_awid,
    output logic [ADDRESS-1:0] m_axi_awaddr,
    output logic [7:0] m_axi_awlen,
    output logic [2:0] m_axi_awsize,
    output logic [1:0] m_axi_awburst,
    output logic m_axi_awvalid,
    input logic m_axi_awready,
    output logic [127:0] m_axi_wdata,
    output logic [15:0] m_axi_wstrb,
    output logic m_axi_wlast,
    output logic m_axi_wvalid,
    input logic m_axi_wready,
    input logic [0:0] m_axi_bid,
    input logic [1:0] m_axi_bresp,
    input logic m_axi_bvalid,
    output logic m_axi_bready,
    output logic [0:0] m_axi_arid,
    output logic [ADDRESS-1:0] m_axi_araddr,
    output logic [7:0] m_axi_arlen,
    output logic [2:0] m_axi_arsize,
    output logic [1:0] m_axi_arburst,
    output logic m_axi_arvalid,
    input logic m_axi_arready,
    input logic [0:0] m_axi_rid,
    input logic [127:0] m_axi_rdata,
    input logic [1:0] m_axi_rresp,
    input logic m_axi_rlast,
    input logic m_axi_rvalid,
    output logic m_axi_rready
);
  localparam UNDERWAY = 8;  // bits of the count of writes without a response

  generate
    if (ADDRESS < 5 || ADDRESS > 36) begin : gen_illegal
      $error("machine_axi: ADDRESS from 5 to 36");
    end
  endgenerate

  // Reset goes through a register: it reaches the whole machine.
  logic rst;
  always_ff @(posedge aclk) rst <= !aresetn;

  // Registers: an address and its word are taken together, an answer waits for its taker.
  logic writes, reads, begins, constant_valid, table_valid, full, failed;
  logic [1:0] phase;
  logic [23:0] visible, entries;
  logic [31:0] constant_index, constant_low, constant_high, constant_exponent, table_index, table_low, table_step;
  logic [31:0] alpha_max, minimum_transmittance, least, least_high, records, most, size, cycles;
  logic [31:0] base_records, base_harmonics, base_packets, base_a, base_b, base_lists, base_frame;
  logic [1:0] flags;
  logic [2:0] degree;
  assign writes = s_axil_awvalid && s_axil_wvalid && !s_axil_bvalid && !rst;
  assign reads = s_axil_arvalid && !s_axil_rvalid && !rst;
  assign {s_axil_awready, s_axil_wready, s_axil_arready} = {writes, writes, reads};
  assign {s_axil_bresp, s_axil_rresp} = 4'd0;
  always_ff @(posedge aclk) begin
    constant_valid <= writes && s_axil_awaddr[6:2] == 5'd7;
    table_valid <= writes && s_axil_awaddr[6:2] == 5'd15;
    begins <= writes && s_axil_awaddr[6:2] == 5'd0 && s_axil_wdata[0];
    if (constant_valid) constant_index <= constant_index + 32'd1;
    if (table_valid) table_index <= table_index + 32'd1;
    if (writes) begin
      case (s_axil_awaddr[6:2])
        5'd4: constant_index <= s_axil_wdata;
        5'd5: constant_low <= s_axil_wdata;
        5'd6: constant_high <= s_axil_wdata;
        5'd7: constant_exponent <= s_axil_wdata;
        5'd8: alpha_max <= s_axil_wdata;
        5'd9: minimum_transmittance <= s_axil_wdata;
        5'd10: least <= s_axil_wdata;
        5'd11: least_high <= s_axil_wdata;
        5'd12: flags <= s_axil_wdata[1:0];
        5'd13: table_index <= s_axil_wdata;
        5'd14: table_low <= s_axil_wdata;
        5'd15: table_step <= s_axil_wdata;
        5'd16: records <= s_axil_wdata;
        5'd17: base_records <= s_axil_wdata;
        5'd18: base_harmonics <= s_axil_wdata;
        5'd19: degree <= s_axil_wdata[2:0];
        5'd20: base_packets <= s_axil_wdata;
        5'd21: base_a <= s_axil_wdata;
        5'd22: base_b <= s_axil_wdata;
        5'd23: base_lists <= s_axil_wdata;
        5'd24: base_frame <= s_axil_wdata;
        5'd25: most <= s_axil_wdata;
        5'd26: size <= s_axil_wdata;
        default: ;
      endcase
    end
    if (reads) begin
      case (s_axil_araddr[6:2])
        5'd0: s_axil_rdata <= {27'd0, failed, full, phase, begins};
        5'd1: s_axil_rdata <= {28'd0, splatline_pkg::PACKET_VERSION};
        5'd2: s_axil_rdata <= {8'(HARMONICS), 8'(CORES), 8'(LANES), 8'(ADDRESS)};
        5'd27: s_axil_rdata <= {8'd0, visible};
        5'd28: s_axil_rdata <= {8'd0, entries};
        5'd29: s_axil_rdata <= cycles;
        default: s_axil_rdata <= 32'd0;
      endcase
    end
    s_axil_bvalid <= writes || (s_axil_bvalid && !s_axil_bready);
    s_axil_rvalid <= reads || (s_axil_rvalid && !s_axil_rready);
    if (phase != 0) cycles <= cycles + 32'd1;
    if (rst || (begins && phase == 0)) cycles <= 0;
    if (rst) begin
      s_axil_bvalid <= 0;
      s_axil_rvalid <= 0;
      begins <= 0;
      constant_valid <= 0;
      table_valid <= 0;
      {constant_index, constant_low, constant_high, constant_exponent, table_index, table_low, table_step} <= '0;
      {alpha_max, minimum_transmittance, least, least_high, flags, records, most, size, degree} <= '0;
      {base_records, base_harmonics, base_packets, base_a, base_b, base_lists, base_frame} <= '0;
    end
  end

  // Reads: the machine holds an address until it is taken, and has a place for the word.
  logic [31:0] read_address;
  assign m_axi_araddr = ADDRESS'({read_address, 4'd0});
  assign {m_axi_arid, m_axi_arlen, m_axi_arsize, m_axi_arburst} = {1'd0, 8'd0, 3'd4, 2'd1};
  assign m_axi_rready = 1;

  // Writes: address and word are offered at the same time and taken each in its own. A write is under way from when the
  // machine hands it over until its response.
  logic write_valid, write_ready, hands_over;
  logic [31:0] write_address;
  logic [127:0] write_word;
  logic [3:0] write_strobe;
  logic [UNDERWAY-1:0] underway;
  assign write_ready = (!m_axi_awvalid || m_axi_awready) && (!m_axi_wvalid || m_axi_wready) && !(&underway);
  assign hands_over = write_valid && write_ready;
  assign {m_axi_awid, m_axi_awlen, m_axi_awsize, m_axi_awburst} = {1'd0, 8'd0, 3'd4, 2'd1};
  assign m_axi_wlast = 1;
  assign m_axi_bready = 1;
  always_ff @(posedge aclk) begin
    if (hands_over) begin
      m_axi_awaddr <= ADDRESS'({write_address, 4'd0});
      m_axi_wdata <= write_word;
      m_axi_wstrb <= {{4{write_strobe[3]}}, {4{write_strobe[2]}}, {4{write_strobe[1]}}, {4{write_strobe[0]}}};
    end
    m_axi_awvalid <= hands_over || (m_axi_awvalid && !m_axi_awready);
    m_axi_wvalid <= hands_over || (m_axi_wvalid && !m_axi_wready);
    underway <= underway + UNDERWAY'(hands_over) - UNDERWAY'(m_axi_bvalid);
    if ((m_axi_bvalid && m_axi_bresp[1]) || (m_axi_rvalid && m_axi_rresp[1])) failed <= 1;
    if (rst || (begins && phase == 0)) failed <= 0;
    if (rst) begin
      m_axi_awvalid <= 0;
      m_axi_wvalid <= 0;
      underway <= 0;
    end
  end

  splatline_pkg::rules_t rules;
  logic [63:0] least_product;
  assign least_product = {least_high, least};
  assign rules = {
    alpha_max[splatline_pkg::ALPHA:0],
    least_product[splatline_pkg::PEAK+splatline_pkg::WEIGHT:0],
    minimum_transmittance[splatline_pkg::TRANSMITTANCE:0],
    flags
  };
  splat_machine #(
      .CORES(CORES),
      .LANES(LANES),
      .HARMONICS(HARMONICS)
  ) machine (
      .clk(aclk),
      .rst,
      .constant_valid,
      .constant_index(constant_index[6:0]),
      .constant_value({constant_high, constant_low}),
      .constant_exponent(constant_exponent[17:0]),
      .rules,
      .table_valid,
      .table_index(table_index[splatline_pkg::TABLE:0]),
      .table_low(table_low[splatline_pkg::WEIGHT:0]),
      .table_step(table_step[splatline_pkg::STEP_BITS-1:0]),
      .begins,
      .records,
      .base_records,
      .base_harmonics,
      .degree,
      .base_packets,
      .base_a,
      .base_b,
      .base_lists,
      .base_frame,
      .most(most[23:0]),
      .columns(size[15:0]),
      .rows(size[31:16]),
      .phase,
      .full,
      .visible,
      .entries,
      .read_valid(m_axi_arvalid),
      .read_ready(m_axi_arready),
      .read_address,
      .word_valid(m_axi_rvalid),
      .word(m_axi_rdata),
      .write_valid,
      .write_ready,
      .write_address,
      .write_word,
      .write_strobe,
      .settled(underway == 0)
  );

  // Every register is written whole, and every transfer is one beat of the one ID.
  logic unused;
  assign unused = &{1'b0, s_axil_awprot, s_axil_arprot, s_axil_wstrb, s_axil_awaddr[1:0], s_axil_araddr[1:0],
                    constant_index, constant_exponent, table_index, table_low, table_step, alpha_max, least_product,
                    minimum_transmittance, most, read_address, write_address, m_axi_bid, m_axi_bresp, m_axi_rid,
                    m_axi_rresp, m_axi_rlast};
endmodule
