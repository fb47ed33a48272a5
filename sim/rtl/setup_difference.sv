// The first step of setup: a splat's centre relative to the eye (`Eye::difference` of src/view.rs), and the record in
// the beats in which the cores read it. A record comes in every eighth cycle at best.
//
//   record | magnitude | length | unit (3) | choice | alignment of centre and eye (4) |
//   difference (3) | their length | choice | alignment (4) | parts | beats (8)
//
// Where a core's words have room for them (TURNED), the axes are turned on the way (setup_turn.sv), and their sums are
// the cores' items.
//
// The difference is exact where coordinates cancel, whatever the offset of the scene, which is why it stands before the
// cores with their factors of 32 bits: it takes 64 bits. Both alignments of 64 bits, the eye's and the difference's,
// take turns at one aligner.
module setup_difference (
    input logic clk,
    input logic rst,
    // The picture's constants: the eye's coordinates and the axes' rotation (30 fraction bits) are kept here.
    input logic constant_valid,
    input logic [6:0] constant_index,
    input logic [63:0] constant_value,
    input logic signed [15:0] eye_exponent,
    input logic signed [15:0] eye_top,  // one above the leading bit of the largest coordinate
    // Taken in phase 0, the first after a reset and then every eighth cycle; `place` says which core and side it is
    // for.
    input logic valid,
    input splatline_setup_pkg::record_t record,
    input logic [6:0] place,
    // Eight beats, from phase 0 on.
    output logic beat_valid,
    output logic [6:0] beat_place,
    output logic [splatline_setup_pkg::BEAT_BITS-1:0] beat
);
  localparam signed [15:0] NOTHING = -16'sd16384;  // leading bit of 0

  function automatic logic [63:0] magnitude(input logic signed [63:0] value);
    magnitude = value[63] ? -value : value;
  endfunction

  // A component of -2^31 counts as -(2^31 - 1), and axes are rounded down to the bits that they need.
  function automatic logic [31:0] component(input logic [31:0] value);
    component = splatline_setup_pkg::AXIS_DROP == 0 && value == 32'h80000000 ? 32'h80000001 : value;
    component = component & 32'hffffffff << splatline_setup_pkg::AXIS_DROP;
  endfunction

  // Four records follow each other, eight cycles apart.
  logic [3:0] valids;
  logic [27:0] places;
  logic [2:0] phase;
  logic first_phase;  // phase 0, in a register of its own: it reaches every bit of the records
  logic [359:0] rest1, rest2, rest3, rest4, rest_in;
  logic [95:0] centre1;
  logic [29:0] exponents1;
  genvar i;
  generate
    for (i = 0; i < 9; i = i + 1) begin : gen_axis
      assign rest_in[36*i+:36] = {4'd0, component(record.axes[32*i+:32])};
    end
  endgenerate
  // Axes' exponents stand in the spare bits, and the weight in the last item.
  assign rest_in[359:324] = {4'd0, record.weight};
  logic [39:0] powers1, powers2, powers3, powers4;
  always_ff @(posedge clk) begin
    phase <= rst ? 3'd0 : phase + 1'b1;
    first_phase <= rst || phase == 3'd7;
    if (first_phase) begin
      valids <= {valids[2:0], valid};
      places <= {places[20:0], place};
      rest1 <= rest_in;
      powers1 <= {record.weight_exponent, record.axis_exponents};
      {rest2, rest3, rest4} <= {rest1, rest2, rest3};
      {powers2, powers3, powers4} <= {powers1, powers2, powers3};
      centre1 <= record.centre;
      exponents1 <= record.centre_exponents;
    end
    if (rst) valids <= 0;
  end

  // Phases 1 to 5: the coordinates' leading bits, one after the other, and the largest of them and the eye's. The unit
  // is 60 bits below.
  logic signed [31:0] coordinate;
  logic [31:0] coordinate_magnitude;
  logic signed [9:0] coordinate_exponent;
  logic [6:0] coordinate_length;
  logic signed [15:0] leading, top, unit, unit_held;
  assign coordinate = phase == 1 ? centre1[31:0] : phase == 2 ? centre1[63:32] : centre1[95:64];
  assign coordinate_length = splatline_math::length({32'd0, coordinate_magnitude});
  assign unit = top - 16'sd60;
  always_ff @(posedge clk) begin
    coordinate_magnitude <= coordinate[31] ? -coordinate : coordinate;
    coordinate_exponent <= phase == 1 ? exponents1[9:0] : phase == 2 ? exponents1[19:10] : exponents1[29:20];
    leading <= coordinate_length == 0 ? NOTHING : 16'(coordinate_exponent) + $signed({9'd0, coordinate_length});
    if (phase == 2) {unit_held, top} <= {unit, eye_top};
    else if ((phase == 3 || phase == 4 || phase == 5) && leading > top) top <= leading;
  end

  // Phases 6, 7 and 0: centre and eye are chosen; phases 1 to 3: the difference, from eleven cycles before. What turn
  // it is has a register for each choice, and what is chosen has one before the aligners, which count its leading bits.
  logic turn_x, turn_y, turn_eye;
  logic [1:0] eye_turn;
  (* ram_style = "distributed" *) logic [63:0] eye[0:3];
  logic signed [31:0] centre_in;
  logic [9:0] exponent_in;
  logic signed [63:0] wide_in, centre_out, wide_out, difference, latest;
  logic [319:0] earlier;
  logic signed [15:0] centre_shift, wide_shift, drop;
  always_ff @(posedge clk) begin
    turn_x <= phase == 5;
    turn_y <= phase == 6;
    turn_eye <= phase == 5 || phase == 6 || phase == 7;
    eye_turn <= phase[1:0] - 2'd1;
    if (constant_valid && constant_index[6:2] == 5'(splatline_setup_pkg::EYE_X / 4)) eye[constant_index[1:0]] <= constant_value;
    centre_in <= turn_x ? centre1[31:0] : turn_y ? centre1[63:32] : centre1[95:64];
    centre_shift <= unit - $signed({{6{exponent_in[9]}}, exponent_in});
    wide_in <= turn_eye ? eye[eye_turn] : earlier[319:256];
    wide_shift <= turn_eye ? unit - eye_exponent : drop;
  end
  assign exponent_in = turn_x ? exponents1[9:0] : turn_y ? exponents1[19:10] : exponents1[29:20];
  // The unit, and then the difference's own, lie so low that nothing is moved out to the left.
  align #(.BITS(32), .SIGNED(1), .SATURATES(0)) align_centre (.clk, .negative(centre_in[31]), .magnitude(centre_in), .shift(centre_shift), .result(centre_out));
  align #(.BITS(64), .SIGNED(1), .SATURATES(0)) align_wide (.clk, .negative(wide_in[63]), .magnitude(wide_in), .shift(wide_shift), .result(wide_out));
  assign difference = centre_out - wide_out;

  // Phases 3 to 5: differences, which come to the aligner six cycles later; 4 to 6: their magnitudes together; 7 and 0:
  // how far they are to be moved.
  logic [63:0] together;
  logic [6:0] together_length;
  logic signed [15:0] exponent;
  always_ff @(posedge clk) begin
    latest <= difference;
    earlier <= {earlier[255:0], latest};
    together <= phase == 4 ? magnitude(latest) : phase == 5 || phase == 6 ? together | magnitude(latest) : together;
    together_length <= splatline_math::length(together);
    if (phase == 0) begin
      drop <= $signed({9'd0, together_length}) - 16'(splatline_setup_pkg::POSITION);
      exponent <= unit_held + $signed({9'd0, together_length}) - 16'(splatline_setup_pkg::POSITION);
    end
  end

  // Phases 6, 7 and 0: the parts of x, y and z, which stand in a beat each, high ones from phase 1 on and low ones
  // right behind them.
  logic signed [63:0] high, low;
  logic [95:0] highs;
  logic [191:0] lows;
  logic [11:0] power, above;
  assign high = splatline_math::shift_round(wide_out, 7'(splatline_setup_pkg::LOW));
  assign low = wide_out - (high <<< splatline_setup_pkg::LOW);
  // High parts stand above their exponent by as many bits as the low ones have.
  assign above = power + 12'(splatline_setup_pkg::LOW);
  always_ff @(posedge clk) begin
    highs <= {highs[63:0], high[31:0]};
    lows <= {lows[159:0], low[31:0]};
    if (phase == 6) power <= exponent[11:0];
  end

  // A beat has an axis' component, of which the last comes beside the others, and something else.
  logic [2:0] beat_phase;
  logic [43:0] axis, last_axis, part;
  logic [9:0] axis_power;
  assign beat_phase = phase - 3'd1;
  assign axis_power = beat_phase < 3'd3 ? powers4[9:0] : beat_phase < 3'd6 ? powers4[19:10] : powers4[29:20];
  generate
    if (splatline_setup_pkg::TURNED != 0) begin : gen_turned
      // Magnitude bits of components and of the rotation's fractions, and those of a sum's window.
      localparam KEPT = 31 - splatline_setup_pkg::AXIS_DROP;
      localparam FRACTION = KEPT < 30 ? KEPT : 30;
      localparam WINDOW = splatline_setup_pkg::MANTISSA + 8;
      localparam SUM = WINDOW + 3;
      logic [9*(KEPT+1)-1:0] parts;
      logic [SUM-1:0] sum, last;
      logic [3:0] entry_place;
      logic [1:0] entry_row, entry_column;
      logic entry_valid;
      for (i = 0; i < 9; i = i + 1) begin : gen_component
        assign parts[i*(KEPT+1)+:KEPT+1] = rest3[36*i+31-:KEPT+1];
      end
      assign entry_place = constant_index[3:0] - 4'(splatline_setup_pkg::AXIS_XX);
      assign {entry_row, entry_column} = entry_place < 4'd3 ? {2'd0, entry_place[1:0]} :
          entry_place < 4'd6 ? {2'd1, entry_place[1:0] - 2'd3} : {2'd2, entry_place[1:0] - 2'd2};
      assign entry_valid = constant_valid && constant_index >= 7'(splatline_setup_pkg::AXIS_XX) &&
          constant_index <= 7'(splatline_setup_pkg::AXIS_ZZ);
      setup_turn #(.PART(KEPT + 1), .ENTRY(FRACTION + 2), .CUT(KEPT + FRACTION - WINDOW), .SUM(SUM)) turn (
          .clk,
          .phase,
          .entry_valid,
          .entry_row,
          .entry_column,
          .entry(constant_value[31-:FRACTION+2]),
          .parts,
          .sum8(sum),
          .last5(last)
      );
      localparam signed [11:0] BELOW = 12'(31 - WINDOW);
      assign axis = {12'($signed(axis_power)) + BELOW, 32'($signed(sum))};
      assign last_axis = {12'($signed(powers4[29:20])) + BELOW, 32'($signed(last))};
    end else begin : gen_unturned
      logic [31:0] component4;
      always_comb begin
        component4 = 0;
        for (int k = 0; k < 8; k = k + 1) if (beat_phase == 3'(k)) component4 = rest4[36*k+:32];
      end
      assign axis = {12'($signed(axis_power)), component4};
      assign last_axis = {12'($signed(powers4[29:20])), rest4[288+:32]};
    end
  endgenerate
  always_comb begin
    if (beat_phase == 3'd7) part = {12'($signed(powers4[39:30])), rest4[324+:32]};
    else if (beat_phase == 3'd6) part = last_axis;
    else if (splatline_setup_pkg::LOW > 0 && beat_phase > 3'd2) part = {power, lows[191:160]};
    else part = {above, highs[95:64]};
  end
  assign beat_valid = valids[3];
  assign beat_place = places[27:21];
  assign beat = {part, axis};
endmodule
