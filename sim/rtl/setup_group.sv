// Cores of the setup unit that obey the same slot, up to four, with their registers and their results.
//
// Were the slot sent to all cores at once, thousands of wires would lead from one place all over the device and back.
// So each group registers its step and hands it to the next group, which does the same a cycle later; results go the
// same way, and leave the last group as many cycles after their request, whichever core they are from.
module setup_group #(
    parameter CORES = 4
) (
    input logic clk,
    input splatline_setup_pkg::step_t step_in,
    output splatline_setup_pkg::step_t step_out,
    // A core's result on its way: the others' are 0.
    input logic [splatline_setup_pkg::WORD_BITS-1:0] word_in,
    output logic [splatline_setup_pkg::WORD_BITS-1:0] word_out
);
  localparam BITS = splatline_setup_pkg::SLOT_BITS;
  localparam WORD = splatline_setup_pkg::WORD_BITS;

  splatline_setup_pkg::step_t step;
  always_ff @(posedge clk) step <= step_in;
  always_comb begin
    step_out = step;
    step_out.load_core = step.load_core - 6'd4;
    step_out.drain_core = step.drain_core - 6'd4;
  end

  splatline_setup_pkg::slot_t slot2;
  assign slot2 = step.slots[2*BITS+:BITS];
  logic [51*CORES-1:0] registers_a, registers_b, core_results;
  logic [9*CORES-1:0] indices;
  logic [32*CORES-1:0] entries;
  genvar i;
  generate
    for (i = 0; i < CORES; i = i + 2) begin : gen_memory
      localparam HERE = i + 1 < CORES ? 2 : 1;
      setup_memory #(
          .CORES(HERE)
      ) memory (
          .clk,
          .write(step.write),
          .write_place(step.write_place),
          .results(core_results[51*i+:51*HERE]),
          .unread_a(step.unread_a),
          .unread_b(step.unread_b),
          .a_place(step.a_place),
          .b_place(step.b_place),
          .a(registers_a[51*i+:51*HERE]),
          .b(registers_b[51*i+:51*HERE]),
          .entry(slot2.entry),
          .index(indices[9*i+:9*HERE]),
          .found(entries[32*i+:32*HERE])
      );
    end
  endgenerate

  logic [CORES-1:0] drains;  // is it this core's turn?
  logic [CORES*WORD-1:0] results;
  generate
    for (i = 0; i < CORES; i = i + 1) begin : gen_core
      logic [50:0] leaves2;
      logic loads;  // is it this core's turn?
      always_ff @(posedge clk) begin
        loads <= step_in.load && step_in.load_core == 6'(i);
        drains[i] <= step_in.drain_core == 6'(i);
      end
      // The direction's words leave beside the others, without their exponents.
      logic beside;
      (* ram_style = "distributed" *) logic [50:0] even_results[0:15];
      (* ram_style = "distributed" *) logic [50:0] odd_results[0:15];
      setup_core core (
          .clk,
          .slots(step.slots),
          .register_a1(registers_a[51*i+:51]),
          .register_b1(registers_b[51*i+:51]),
          .result21(core_results[51*i+:51]),
          .index2(indices[9*i+:9]),
          .table4(entries[32*i+:32]),
          .constant1(step.constant1),
          .picked3(step.picked3),
          .offset3(step.offset3),
          .right4(step.right4),
          .start14(step.start14),
          .half19(step.half19),
          .mask19(step.mask19),
          .load(loads),
          .load_place(step.load_place),
          .load_beat(step.load_beat),
          .side(step.side),
          .out2(leaves2)
      );
      always_ff @(posedge clk) begin
        if (slot2.out && !beside && !slot2.word[0]) even_results[{step.out_side, slot2.word[3:1]}] <= leaves2;
        if (slot2.out && !beside && slot2.word[0]) odd_results[{step.out_side, slot2.word[3:1]}] <= leaves2;
      end
      logic [WORD-1:0] result;
      if (splatline_setup_pkg::DIRECTS) begin : gen_direction
        (* ram_style = "distributed" *) logic [32:0] directions[0:15];
        assign beside = slot2.word[4];
        always_ff @(posedge clk) if (slot2.out && beside) directions[{step.out_side, slot2.word[2:0]}] <= leaves2[50:18];
        assign result = {directions[step.drain_place], even_results[step.drain_place], odd_results[step.drain_place]};
      end else begin : gen_no_direction
        assign beside = 0;
        assign result = {even_results[step.drain_place], odd_results[step.drain_place]};
      end
      assign results[i*WORD+:WORD] = result;
    end
  endgenerate

  // One of two cores, reset where it is neither's turn: of words that are 0 the sum needs no choice.
  localparam PAIRS = (CORES + 1) / 2;
  logic [PAIRS*WORD-1:0] drained;
  generate
    for (i = 0; i < CORES; i = i + 2) begin : gen_pair
      if (i + 1 < CORES) begin : gen_two
        always_ff @(posedge clk) begin
          if (drains[i+:2] == 0) drained[i/2*WORD+:WORD] <= 0;
          else drained[i/2*WORD+:WORD] <= drains[i] ? results[i*WORD+:WORD] : results[(i+1)*WORD+:WORD];
        end
      end else begin : gen_one
        always_ff @(posedge clk) begin
          if (!drains[i]) drained[i/2*WORD+:WORD] <= 0;
          else drained[i/2*WORD+:WORD] <= results[i*WORD+:WORD];
        end
      end
    end
  endgenerate
  logic [WORD-1:0] chosen;
  always_comb begin
    chosen = word_in;
    for (int pair = 0; pair < PAIRS; pair = pair + 1) chosen = chosen | drained[pair*WORD+:WORD];
  end
  always_ff @(posedge clk) word_out <= chosen;
endmodule
