// The splat primitive with one C integer for each port, for simulation; the handshakes inside it whose cycles are
// compared; and the row unit's root, whose last bit no pixel shows.
module flat_primitive #(
    parameter LANES = 1,
    parameter SETUP_INTERVAL = 4,
    parameter ROW_INTERVAL = 1,
    parameter ADDED_BITS = 4,
    parameter WIDE_MULTIPLIERS = 4
) (
    input logic clk,
    input logic rst,
    input logic [31:0] alpha_max,
    input logic [63:0] least,
    input logic [31:0] minimum_transmittance,
    input logic omit_finishing,
    input logic wide_table,
    input logic table_valid,
    input logic [31:0] table_index,
    input logic [31:0] table_low,
    input logic [31:0] table_step,
    input logic tile_valid,
    output logic tile_ready,
    input logic [15:0] first_column,
    input logic [15:0] first_row,
    input logic [15:0] end_column,
    input logic [15:0] end_row,
    input logic packet_valid,
    output logic packet_ready,
    input logic [splatline_pkg::PACKET_BITS-1:0] packet,
    input logic finish_valid,
    output logic finish_ready,
    output logic pixel_valid,
    input logic pixel_ready,
    output logic finished,
    output logic [31:0] transmittance,
    output logic [31:0] red,
    output logic [31:0] green,
    output logic [31:0] blue,
    input logic lanes_enable,
    output logic raster_idle,
    output logic idle,
    output logic [15:0] foreign_packets,
    output logic splat_begun,  // the row generator takes a splat over
    output logic run_left,  // a run leaves the row generator
    output logic [15:0] lanes_popped,  // lanes that pop a run from their queues
    output logic [63:0] squared,  // what the row unit takes the root of
    output logic squared_valid,
    output logic [31:0] root,  // and the root, five stages later
    output logic root_valid,
    // Two units by themselves.
    input logic unit_negative,
    input logic [63:0] unit_magnitude,
    input logic [15:0] unit_shift,
    output logic [63:0] aligned,  // four cycles later
    output logic [31:0] normal,  // three cycles later
    output logic normal_negative,
    output logic [15:0] normal_exponent
);
  localparam SUM = splatline_pkg::SUM_BITS;
  splatline_pkg::rules_t rules;
  splatline_pkg::window_t tile;
  logic [splatline_pkg::TRANSMITTANCE+1:0] word;
  logic [3*SUM-1:0] colour;

  assign rules = {alpha_max[splatline_pkg::ALPHA:0], least[splatline_pkg::PEAK+splatline_pkg::WEIGHT:0], minimum_transmittance[splatline_pkg::TRANSMITTANCE:0], omit_finishing, wide_table};
  assign tile = {first_column, first_row, end_column, end_row};
  assign finished = word[splatline_pkg::TRANSMITTANCE+1];
  assign transmittance = 32'(word[splatline_pkg::TRANSMITTANCE:0]);
  assign {blue, green, red} = {32'(colour[2*SUM+:SUM]), 32'(colour[SUM+:SUM]), 32'(colour[0+:SUM])};

  splat_primitive #(
      .LANES(LANES),
      .SETUP_INTERVAL(SETUP_INTERVAL),
      .ROW_INTERVAL(ROW_INTERVAL),
      .ADDED_BITS(ADDED_BITS),
      .WIDE_MULTIPLIERS(WIDE_MULTIPLIERS)
  ) splats (
      .clk,
      .rst,
      .rules,
      .table_valid,
      .table_index(table_index[splatline_pkg::TABLE:0]),
      .table_low(table_low[splatline_pkg::WEIGHT:0]),
      .table_step(table_step[splatline_pkg::STEP_BITS-1:0]),
      .tile_valid,
      .tile_ready,
      .tile,
      .packet_valid,
      .packet_ready,
      .packet,
      .finish_valid,
      .finish_ready,
      .pixel_valid,
      .pixel_ready,
      .pixel_transmittance(word),
      .pixel_colour(colour),
      .lanes_enable,
      .raster_idle,
      .idle,
      .foreign_packets
  );

  assign splat_begun = splats.splat_valid && splats.splat_ready;
  assign run_left = splats.slot_valid && splats.slot_has_run && splats.slot_ready;
  assign squared = splats.rows.squared5;
  assign squared_valid = splats.rows.open[5];
  assign root = 32'(splats.rows.root10);
  assign root_valid = splats.rows.open[10];
  align #(
      .BITS(40)
  ) check_align (
      .clk,
      .negative(unit_negative),
      .magnitude(unit_magnitude[39:0]),
      .shift(unit_shift),
      .result(aligned)
  );
  logic [splatline_pkg::MANTISSA-1:0] normal_mantissa;
  logic signed [splatline_pkg::EXPONENT-1:0] short_exponent;
  normalise #(
      .BITS(40)
  ) check_normalise (
      .clk,
      .negative(unit_negative),
      .magnitude(unit_magnitude[39:0]),
      .exponent('0),
      .result_negative(normal_negative),
      .result(normal_mantissa),
      .result_exponent(short_exponent)
  );
  assign normal = 32'(normal_mantissa);
  assign normal_exponent = 16'(short_exponent);
  genvar l;
  generate
    for (l = 0; l < 16; l = l + 1) begin : gen_popped
      if (l < LANES) assign lanes_popped[l] = splats.gen_lane[l].queued && splats.gen_lane[l].taken;
      else assign lanes_popped[l] = 1'b0;
    end
  endgenerate
endmodule
