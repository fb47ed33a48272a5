// Units of splat setup that its stages take in turn: alignment, normalisation, product. Splats come INTERVAL cycles
// apart at least; a stage needs its unit in one cycle of as many, so that so many stages do with one. With 1 each stage
// has a unit of its own.
//
// A stage's place is its cycle modulo 8, and `phase` says whose turn it is: inputs of all stages come in, and the
// result, a cycle later than the unit itself gives it, is of use to the stage whose inputs were taken. So what stands
// around these units is the same for all intervals. With 4, places 0 to 3 share a unit and places 4 to 7 another one.
//
// For each unit, of the places of BITS bits that it has the phase's, registered.
module turn #(
    parameter BITS = 8,
    parameter INTERVAL = 4
) (
    input logic clk,
    input logic [2:0] phase,
    input logic [8*BITS-1:0] in,
    output logic [8/INTERVAL*BITS-1:0] out
);
  genvar unit, i;
  generate
    if (INTERVAL == 1) begin : gen_all
      logic unused;
      assign unused = &{1'b0, phase};
      always_ff @(posedge clk) out <= in;
    end else begin : gen_turns
      // Of four places each the phase's.
      logic [2*BITS-1:0] fours;
      for (i = 0; i < 2; i = i + 1) begin : gen_four
        assign fours[i*BITS+:BITS] = phase[1] ? (phase[0] ? in[(4*i+3)*BITS+:BITS] : in[(4*i+2)*BITS+:BITS]) :
            (phase[0] ? in[(4*i+1)*BITS+:BITS] : in[4*i*BITS+:BITS]);
      end
      for (unit = 0; unit < 8 / INTERVAL; unit = unit + 1) begin : gen_unit
        always_ff @(posedge clk) out[unit*BITS+:BITS] <= INTERVAL == 8 && phase[2] ? fours[BITS+:BITS] : fours[unit*BITS+:BITS];
      end
    end
  endgenerate
endmodule
