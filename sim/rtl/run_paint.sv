// What blending needs of the runs of a lane: it lies where the lane's queue took the run, and pixels carry their run's
// number, not their paint. The peak is read in one stage of the pipeline, the colour in another, both into a register.
//
// A run's words may be needed while DEPTH runs wait behind it and eight are behind the queue: one in front of the
// lane, one in it, and as many as fit in the stages behind it, where runs are two cycles apart at least. Hence SLOTS
// is DEPTH + 8 or more.
module run_paint #(
    parameter SLOTS = 16
) (
    input logic clk,
    input logic write,
    input logic [$clog2(SLOTS)-1:0] write_slot,
    input splatline_pkg::paint_t paint,
    input logic peak_advance,
    input logic [$clog2(SLOTS)-1:0] peak_slot,
    output logic [splatline_pkg::PEAK+3:0] peak,
    input logic colour_advance,
    input logic [$clog2(SLOTS)-1:0] colour_slot,
    output logic [3*splatline_pkg::COLOUR_BITS-1:0] colour,  // blue, green, red
    output logic [53:0] colour_sums  // of each its halves', for multiply_three.sv
);
  logic [splatline_pkg::PEAK+3:0] peaks[0:SLOTS-1];
  localparam C = splatline_pkg::COLOUR_BITS;
  logic [3*C-1:0] colours[0:SLOTS-1];
  logic [3*C-1:0] read;
  assign read = colours[colour_slot];

  always_ff @(posedge clk) begin
    if (write) begin
      peaks[write_slot] <= paint.peak;
      colours[write_slot] <= {paint.blue, paint.green, paint.red};
    end
    if (peak_advance) peak <= peaks[peak_slot];
    if (colour_advance) begin
      colour <= read;
      for (int i = 0; i < 3; i = i + 1) colour_sums[18*i+:18] <= splatline_math::halves(34'(read[C*i+:C]));
    end
  end
endmodule
