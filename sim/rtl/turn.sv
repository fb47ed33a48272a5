// Units of splat setup that up to four of its stages take in turn: alignment, normalisation, product. Splats come
// INTERVAL cycles apart at least; with 4, a stage needs its unit in every fourth cycle alone, so that four stages do
// with one. With 1 each stage has a unit of its own.
//
// A stage's place is its cycle modulo 4, and `phase` says whose turn it is: inputs of all stages come in, and the
// result, a cycle later than the unit itself gives it, is of use to the stage whose inputs were taken. So what stands
// around these units is the same for both intervals.
//
// The phase's part of four parts of BITS bits, registered; with INTERVAL = 1 all four.
module turn #(
    parameter BITS = 8,
    parameter INTERVAL = 4
) (
    input logic clk,
    input logic [1:0] phase,
    input logic [4*BITS-1:0] in,
    output logic [(INTERVAL==4?1:4)*BITS-1:0] out
);
  generate
    if (INTERVAL == 4) begin : gen_one
      always_ff @(posedge clk) out <= phase[1] ? (phase[0] ? in[3*BITS+:BITS] : in[2*BITS+:BITS]) : (phase[0] ? in[BITS+:BITS] : in[0+:BITS]);
    end else begin : gen_all
      logic unused;
      assign unused = &{1'b0, phase};
      always_ff @(posedge clk) out <= in;
    end
  endgenerate
endmodule
