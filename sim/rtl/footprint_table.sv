// The footprint table with interpolation (src/kernel/mod.rs): radial index in, kernel weight out, five cycles later.
//
// An entry holds the kernel at the start of its interval and the step down to its end, so that one read serves the
// interpolator. Entries are written from outside: another kernel or range is another table, not another circuit. The
// entry at the table's end, whose step leads to 0, is a register, which leaves 2^TABLE entries for the memory.
module footprint_table (
    input logic clk,
    input logic advance,
    input logic write_valid,
    input logic [splatline_pkg::TABLE:0] write_index,
    input logic [splatline_pkg::WEIGHT:0] write_low,
    input logic [splatline_pkg::STEP_BITS-1:0] write_step,
    input logic wide_table,
    input logic [splatline_pkg::RADIAL+3:0] radial,
    output logic [splatline_pkg::WEIGHT:0] weight  // UQ1.weight
);
  localparam RADIAL = splatline_pkg::RADIAL;
  localparam TABLE = splatline_pkg::TABLE;
  localparam KEPT = splatline_pkg::INTERPOLATION;
  localparam WEIGHT = splatline_pkg::WEIGHT;
  localparam STEP = splatline_pkg::STEP_BITS;
  localparam LOWER = STEP < 18 ? STEP : 18;

  // Loaded before anything is drawn: an entry that is read while it is written is nobody's.
  (* no_rw_check *) logic [STEP+WEIGHT:0] entries[0:(1<<TABLE)-1];
  logic [STEP+WEIGHT:0] end_entry;

  // The position within an interval, KEPT bits of it. Ranges of 4 and 16 differ by two bits of the index.
  logic [TABLE+1:0] index;
  logic [RADIAL+3:0] aligned;
  assign index = wide_table ? {2'b00, radial[RADIAL+3:RADIAL+4-TABLE]} : radial[RADIAL+3:RADIAL+2-TABLE];
  assign aligned = wide_table ? radial : radial << 2;

  // Stages 1 and 2: memory, and a register, since block RAM is slow. Stage 3: what the table says. Stage 4: the
  // products of the step's lower 18 bits, which one multiplier takes, and of those above. Stage 5 adds them, since
  // multipliers and their sum in one cycle would be the circuit's longest path.
  logic [STEP+WEIGHT:0] entry1, entry2;
  logic at_end1, at_end2, beyond1, beyond2;
  logic [KEPT-1:0] fraction1, fraction2, fraction3;
  logic [WEIGHT:0] low3, low4;
  logic [STEP-1:0] step3;
  logic [LOWER+KEPT-1:0] lower4;
  logic [STEP+KEPT-1:0] product4;

  generate
    if (STEP > LOWER) begin : gen_upper
      logic [STEP-LOWER+KEPT-1:0] upper4;
      always_ff @(posedge clk) if (advance) upper4 <= step3[STEP-1:LOWER] * fraction3;
      assign product4 = {upper4 + (STEP - LOWER + KEPT)'(lower4[LOWER+KEPT-1:LOWER]), lower4[LOWER-1:0]};
    end else begin : gen_alone
      assign product4 = lower4;
    end
  endgenerate

  // Rounded to nearest as the kernel does: low + ((-step fraction + half) >> KEPT), which is
  // ((low << KEPT) + half - step fraction) >> KEPT: halves round down, and one subtraction serves both.
  logic [WEIGHT+KEPT:0] lowered4;
  assign lowered4 = {low4, 1'b1, {(KEPT - 1) {1'b0}}} - (WEIGHT + KEPT + 1)'(product4);

  always_ff @(posedge clk) begin
    if (write_valid && write_index[TABLE]) end_entry <= {write_step, write_low};
    if (write_valid && !write_index[TABLE]) entries[write_index[TABLE-1:0]] <= {write_step, write_low};
    if (advance) begin
      entry1 <= entries[index[TABLE-1:0]];
      at_end1 <= index == (1 << TABLE);
      beyond1 <= index > (1 << TABLE);
      fraction1 <= aligned[RADIAL+3-TABLE:RADIAL+4-TABLE-KEPT];
      entry2 <= entry1;
      at_end2 <= at_end1;
      beyond2 <= beyond1;
      fraction2 <= fraction1;
      {step3, low3} <= beyond2 ? '0 : at_end2 ? end_entry : entry2;
      fraction3 <= fraction2;
      low4 <= low3;
      lower4 <= step3[LOWER-1:0] * fraction3;
      weight <= lowered4[WEIGHT+KEPT:KEPT];
    end
  end
endmodule
