// BITS bits, STAGES cycles later: what a value has to wait for while its pipeline computes something else from it.
//
// A few stages are registers. Longer ones are a ring, since registers for every stage of every field would outnumber
// the arithmetic: up to 17 stages in look-up tables, and from there on in block RAM (a read, then a register). Block
// RAM stands in a few lines across the device, and a circuit that takes much of it is drawn apart along them: all its
// wires become longer.
module delay #(
    parameter BITS = 8,
    parameter STAGES = 1
) (
    input logic clk,
    input logic rst,
    input logic advance,
    input logic [BITS-1:0] in,
    output logic [BITS-1:0] out
);
  // From so many bits and stages on a ring pays.
  localparam RING = STAGES >= 8 && BITS >= 16;
  // What a look-up table holds as a memory, and the register behind it.
  localparam SHORT = STAGES <= 17;

  generate
    if (STAGES == 0) begin : gen_wire
      logic unused;
      assign unused = &{1'b0, clk, rst, advance};
      assign out = in;
    end else if (RING) begin : gen_ring
      // Cycles that pass behind the memory: in `out`, and in block RAM's `word` before it.
      localparam BEHIND = SHORT ? 1 : 2;
      // A look-up table's word is read before it is written again in the same cycle; block RAM has a word more, so that
      // both never meet.
      localparam PLACE = $clog2(SHORT ? STAGES - 1 : STAGES);
      // Where to write, and where what came STAGES - BEHIND cycles ago lies. Each ring keeps counters of its own beside
      // its memory, although those of all rings of a size say the same.
      logic [PLACE-1:0] place, from;
      (* keep *)
      always_ff @(posedge clk) begin
        if (rst) begin
          place <= 0;
          from <= PLACE'(0) - PLACE'(STAGES - BEHIND);
        end else if (advance) begin
          place <= place + 1'b1;
          from <= from + 1'b1;
        end
      end
      if (SHORT) begin : gen_tables
        logic [BITS-1:0] memory[0:(1<<PLACE)-1];
        always_ff @(posedge clk)
          if (advance) begin
            memory[place] <= in;
            out <= memory[from];
          end
      end else begin : gen_block
        (* ram_style = "block", no_rw_check *) logic [BITS-1:0] memory[0:(1<<PLACE)-1];
        logic [BITS-1:0] word;
        always_ff @(posedge clk)
          if (advance) begin
            memory[place] <= in;
            word <= memory[from];
            out <= word;
          end
      end
    end else begin : gen_registers
      logic [BITS*STAGES-1:0] stages;
      logic unused;
      assign unused = &{1'b0, rst};
      assign out = stages[BITS*STAGES-1-:BITS];
      if (STAGES == 1) begin : gen_one
        always_ff @(posedge clk) if (advance) stages <= in;
      end else begin : gen_more
        always_ff @(posedge clk) if (advance) stages <= {stages[BITS*(STAGES-1)-1:0], in};
      end
    end
  endgenerate
endmodule
