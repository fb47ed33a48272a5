// A splat's direction in the scene's axes: the unit vector that a core gives in the camera's, turned back by the
// transposed rotation in exact Q.30 (`direction` of src/setup/harmonics.rs), a splat in eight cycles. In parallel
// projection that vector is the third axis. The kernel does not clamp what comes of it, a row of the rotation; the
// harmonics of both do.
//
//   words, clamped | halves, entries | parts of products | products | two terms and one | sum |
//   both halves | clamped | kept
//
// Three products for each of three axes are nine, one too many for one multiplier and eight cycles. So each row has one
// for half a word, which takes an axis in two cycles, the lower half first.
module setup_direction (
    input logic clk,
    input logic [2:0] phase,
    input logic perspective,
    // The rotation's entries stand behind those by which axes are turned.
    input logic constant_valid,
    input logic [6:0] constant_index,
    input logic [31:0] constant_value,
    // x, y and z of the vector in phases 0 to 2, with 30 fraction bits.
    input logic signed [32:0] word,
    // From phase 1 on, two rounds of phases later, for eight cycles.
    output logic [95:0] direction
);
  localparam signed [31:0] ONE = 32'sd1 << 30;
  localparam [6:0] ENTRIES = 7'(splatline_setup_pkg::AXIS_XX) + 7'd9;

  // Between -1 and 1: what is beyond has not all its bits from 2^30 on alike, or is 1 itself.
  logic [31:0] clamped;
  assign clamped = word[32:30] == {3{word[32]}} ? word[31:0] : word[32] ? -ONE : ONE;
  logic [95:0] unit;
  always_ff @(posedge clk) begin
    if (phase == 3'd0) unit[31:0] <= perspective ? clamped : 32'd0;
    if (phase == 3'd1) unit[63:32] <= perspective ? clamped : 32'd0;
    if (phase == 3'd2) unit[95:64] <= perspective ? clamped : ONE;
  end

  // From phase 3 on: axis by axis, half by half.
  logic [1:0] axis;
  logic upper;
  assign axis = 2'((phase - 3'd3) >> 1);
  assign upper = !phase[0];
  logic [3*49-1:0] products;
  genvar row;
  generate
    for (row = 0; row < 3; row = row + 1) begin : gen_row
      (* ram_style = "distributed" *) logic [31:0] entries[0:3];
      logic [6:0] place;
      logic [31:0] part, entry1;
      logic signed [16:0] half1;
      logic signed [32:0] high2;
      logic signed [33:0] low2;
      assign place = constant_index - ENTRIES - 7'(3 * row);
      assign part = unit[32*row+:32];
      always_ff @(posedge clk) begin
        if (constant_valid && place < 7'd3) entries[place[1:0]] <= constant_value;
        entry1 <= entries[axis];
        half1 <= upper ? {part[31], part[31:16]} : {1'b0, part[15:0]};
        high2 <= 33'($signed(entry1[31:16])) * 33'(half1);
        low2 <= $signed(34'({1'b0, entry1[15:0]})) * 34'(half1);
        products[49*row+:49] <= {high2 + 33'($signed(low2[33:16])), low2[15:0]};
      end
    end
  endgenerate

  // The sum of all six, with half of its last bit.
  function automatic logic signed [50:0] term(input logic [48:0] value);
    term = 51'($signed(value));
  endfunction
  logic signed [50:0] pair4, third4, sum5;
  logic signed [63:0] sum6;
  logic signed [33:0] rounded6;
  logic [31:0] turned6;
  logic [95:0] turned7;
  assign rounded6 = sum6[63:30];
  always_comb begin
    turned6 = rounded6[31:0];
    if (rounded6[33:30] != {4{rounded6[33]}}) turned6 = rounded6[33] ? -ONE : ONE;
  end
  always_ff @(posedge clk) begin
    pair4 <= term(products[0+:49]) + term(products[49+:49]);
    third4 <= term(products[98+:49]);
    sum5 <= pair4 + third4;
    // Its lower halves come in even phases.
    sum6 <= (phase[0] ? sum6 : 64'sd1 << 29) + (phase[0] ? 64'(sum5) <<< 16 : 64'(sum5));
    if (!phase[0]) turned7 <= {turned6, turned7[95:32]};
    // Of phases 2, 4 and 6.
    if (phase == 3'd0) direction <= turned7;
  end
endmodule
