// The primitive between registers, on three pins: for place and route, which cannot bond out a packet of 472 bits. Every input comes
// from a shift register, every output goes into one bit through registers.
module timing_wrapper #(
    parameter LANES = 1
) (
    input logic clk,
    input logic serial_in,
    output logic serial_out
);
  localparam RULES = 2 * splatline_pkg::ALPHA + splatline_pkg::TRANSMITTANCE + 5;
  localparam ENTRY = splatline_pkg::TABLE + splatline_pkg::WEIGHT + splatline_pkg::STEP_BITS + 2;
  localparam INPUTS = 7 + RULES + ENTRY + 64 + splatline_pkg::PACKET_BITS;
  localparam OUTPUTS = 22 + splatline_pkg::TRANSMITTANCE + 2 + 3 * splatline_pkg::SUM_BITS;

  logic [INPUTS-1:0] inputs;
  logic [OUTPUTS-1:0] outputs, sampled;

  splat_primitive #(
      .LANES(LANES)
  ) splats (
      .clk,
      .rst(inputs[0]),
      .table_valid(inputs[1]),
      .tile_valid(inputs[2]),
      .packet_valid(inputs[3]),
      .finish_valid(inputs[4]),
      .pixel_ready(inputs[5]),
      .lanes_enable(inputs[6]),
      .rules(inputs[7+:RULES]),
      .table_index(inputs[7+RULES+:splatline_pkg::TABLE+1]),
      .table_low(inputs[8+RULES+splatline_pkg::TABLE+:splatline_pkg::WEIGHT+1]),
      .table_step(inputs[7+RULES+ENTRY-splatline_pkg::STEP_BITS+:splatline_pkg::STEP_BITS]),
      .tile(inputs[7+RULES+ENTRY+:64]),
      .packet(inputs[71+RULES+ENTRY+:splatline_pkg::PACKET_BITS]),
      .tile_ready(outputs[0]),
      .packet_ready(outputs[1]),
      .finish_ready(outputs[2]),
      .pixel_valid(outputs[3]),
      .raster_idle(outputs[4]),
      .idle(outputs[5]),
      .foreign_packets(outputs[21:6]),
      .pixel_depth(outputs[22+:splatline_pkg::TRANSMITTANCE+2]),
      .pixel_colour(outputs[24+splatline_pkg::TRANSMITTANCE+:3*splatline_pkg::SUM_BITS])
  );

  always_ff @(posedge clk) begin
    inputs <= {inputs[INPUTS-2:0], serial_in};
    // Loads all outputs while a one is shifted in, and shifts them out otherwise.
    sampled <= inputs[0] ? outputs : {sampled[OUTPUTS-2:0], 1'b0};
    serial_out <= sampled[OUTPUTS-1];
  end
endmodule
