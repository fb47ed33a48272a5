// Packet in, footprint out. The packed struct of the generated package is the packet's layout
// (src/footprint/packet.rs), so that decoding is wiring; a packet of another version is taken and dropped, and counted.
module packet_decode (
    input logic clk,
    input logic rst,
    input logic packet_valid,
    output logic packet_ready,
    input logic [splatline_pkg::PACKET_BITS-1:0] packet,
    output logic footprint_valid,
    input logic footprint_ready,
    output splatline_pkg::footprint_t footprint,
    output logic [15:0] foreign_packets
);
  logic foreign;

  assign footprint = packet;
  assign foreign = footprint.version != splatline_pkg::PACKET_VERSION;
  assign footprint_valid = packet_valid && !foreign;
  assign packet_ready = footprint_ready || foreign;

  always_ff @(posedge clk)
    if (rst) foreign_packets <= 0;
    else if (packet_valid && foreign) foreign_packets <= foreign_packets + 16'd1;
endmodule
