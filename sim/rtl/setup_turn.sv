// The axes of a splat turned by the camera (`rotate_axis` of src/setup/jacobian.rs), a splat in eight cycles: nine sums
// of three products, each cut to the window of a sum, not yet rounded. All terms of a sum have one exponent, so that
// nothing is aligned and a core's slots are not needed.
//
//   choice | parts of products | their sums | products, cut | two terms and one | sum | two cycles more
//
// Three multipliers make the first eight sums, one in each cycle; a fourth makes the terms of the ninth in turn.
module setup_turn #(
    parameter PART = 25,  // bits of a component, and of an entry of the rotation, signs included
    parameter ENTRY = 26,
    parameter CUT = 22,  // bits of a product that the window leaves off
    parameter SUM = 29  // bits of a sum
) (
    input logic clk,
    input logic [2:0] phase,
    // An entry of the rotation, and where it stands.
    input logic entry_valid,
    input logic [1:0] entry_row,
    input logic [1:0] entry_column,
    input logic [ENTRY-1:0] entry,
    // x, y, z of the first axis, then of the others, from phase 1 on.
    input logic [9*PART-1:0] parts,
    // The sums of the first axis' rows, then of the others: number k in phase k + 1, the last from phase 4 on for six.
    output logic signed [SUM-1:0] sum8,
    output logic signed [SUM-1:0] last5
);
  // A cut product, three cycles later: parts of 17 bits and a sign.
  localparam BITS = PART + ENTRY - CUT;
  logic [3*PART-1:0] axis1;
  logic [3*ENTRY-1:0] row1;
  logic [PART-1:0] last_part1;
  logic [ENTRY-1:0] last_entry1;
  // The rotation's columns by their rows, and its last row: a memory of look-up tables takes less than a choice.
  (* ram_style = "distributed" *) logic [ENTRY-1:0] column_x[0:3];
  (* ram_style = "distributed" *) logic [ENTRY-1:0] column_y[0:3];
  (* ram_style = "distributed" *) logic [ENTRY-1:0] column_z[0:3];
  (* ram_style = "distributed" *) logic [ENTRY-1:0] last_row[0:3];
  // Whose turn the next cycle is: registers, so that a bit's choice has two inputs more than its sources.
  logic [1:0] axis_turn, row_turn, last_turn;
  always_ff @(posedge clk) begin
    axis_turn <= phase < 3'd3 ? 2'd0 : phase < 3'd6 ? 2'd1 : 2'd2;
    row_turn <= phase == 3'd0 || phase == 3'd3 || phase == 3'd6 ? 2'd0 : phase == 3'd2 || phase == 3'd5 ? 2'd2 : 2'd1;
    last_turn <= phase == 3'd4 ? 2'd0 : phase == 3'd5 ? 2'd1 : 2'd2;
    axis1 <= axis_turn[1] ? parts[6*PART+:3*PART] : axis_turn[0] ? parts[3*PART+:3*PART] : parts[0+:3*PART];
    row1 <= {column_z[row_turn], column_y[row_turn], column_x[row_turn]};
    last_part1 <= last_turn[1] ? parts[8*PART+:PART] : last_turn[0] ? parts[7*PART+:PART] : parts[6*PART+:PART];
    last_entry1 <= last_row[last_turn];
    if (entry_valid && entry_column == 2'd0) column_x[entry_row] <= entry;
    if (entry_valid && entry_column == 2'd1) column_y[entry_row] <= entry;
    if (entry_valid && entry_column == 2'd2) column_z[entry_row] <= entry;
    if (entry_valid && entry_row == 2'd2) last_row[entry_column] <= entry;
  end

  logic [4*BITS-1:0] cuts4;
  genvar i;
  generate
    for (i = 0; i < 4; i = i + 1) begin : gen_product
      logic signed [PART-1:0] a;
      logic signed [ENTRY-1:0] b;
      logic signed [PART+ENTRY-35:0] high2;
      logic signed [PART:0] cross2;
      logic signed [ENTRY:0] crossed2;
      logic [33:0] low2;
      logic signed [PART+ENTRY-18:0] high3, upper3;
      logic signed [ENTRY+1:0] cross3;
      assign a = i == 3 ? last_part1 : axis1[(i%3)*PART+:PART];
      assign b = i == 3 ? last_entry1 : row1[(i%3)*ENTRY+:ENTRY];
      assign upper3 = high3 + (PART + ENTRY - 17)'(cross3);
      always_ff @(posedge clk) begin
        high2 <= (PART + ENTRY - 34)'($signed(a[PART-1:17])) * (PART + ENTRY - 34)'($signed(b[ENTRY-1:17]));
        cross2 <= (PART + 1)'($signed(a[PART-1:17])) * $signed((PART + 1)'({1'b0, b[16:0]}));
        crossed2 <= $signed((ENTRY + 1)'({1'b0, a[16:0]})) * (ENTRY + 1)'($signed(b[ENTRY-1:17]));
        low2 <= a[16:0] * b[16:0];
        high3 <= {high2, low2[33:17]};
        cross3 <= (ENTRY + 2)'(cross2) + (ENTRY + 2)'(crossed2);
        cuts4[i*BITS+:BITS] <= upper3[PART+ENTRY-18:CUT-17];
      end
    end
  endgenerate

  logic signed [SUM-1:0] pair5, third5, sum6, sum7;
  function automatic logic signed [SUM-1:0] cut(input logic [BITS-1:0] value);
    cut = SUM'($signed(value));
  endfunction
  always_ff @(posedge clk) begin
    pair5 <= cut(cuts4[0+:BITS]) + cut(cuts4[BITS+:BITS]);
    third5 <= cut(cuts4[2*BITS+:BITS]);
    sum6 <= pair5 + third5;
    {sum7, sum8} <= {sum6, sum7};
    // The last sum's terms come in phases 1 to 3.
    if (phase == 3'd1) last5 <= cut(cuts4[3*BITS+:BITS]);
    if (phase == 3'd2 || phase == 3'd3) last5 <= last5 + cut(cuts4[3*BITS+:BITS]);
  end
endmodule
