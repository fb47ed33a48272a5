// Splat setup: records of volume splats in, footprint packets out, in the same order, each with the reason for which it
// is culled (0: none; 1 near, 2 far, 3 range, 4 degenerate, 5 transparent, 6 outside). Packet and reason equal those of
// the kernel's `setup` (src/setup).
//
//   record -> setup_difference -> CORES x setup_core -> setup_pack -> fifo; cores stand in fours (setup_group.sv)
//                                                  `-> setup_direction -> direction
//
// A program with directions gives the direction of each splat as well (`direction` of src/setup/harmonics.rs), before
// its packet leaves the queue. Whoever takes it must have a place for each of the queue's packets.
//
// The program of a splat has ROUND slots (splatline_setup_pkg, generated). All cores obey the same slot, group after
// group, each for its own splat, so that a round takes up to CORES splats in: one in ROUND / CORES cycles, in eight at
// best. That is the trade of multipliers for speed: a core has four multipliers of 18 bits. What needs 64 bits once for
// a splat stands before and behind the cores, once for all of them.
//
// Nothing branches: a culled splat takes as long as another. A round begins as soon as the one before has ended,
// whether records wait or not; only if the results of the round before the last are still on their way out, no slot is
// issued. So nothing in flight ever has to stop.
//
// Camera and rules are constants that `constant_*` writes before the first record; addresses are those of the package's
// constants.
module setup_unit #(
    parameter CORES = 4
) (
    input logic clk,
    input logic rst,
    input logic constant_valid,
    input logic [6:0] constant_index,
    input logic [63:0] constant_value,
    input logic [17:0] constant_exponent,
    input logic record_valid,
    output logic record_ready,
    input splatline_setup_pkg::record_t record,
    output logic packet_valid,
    input logic packet_ready,
    output logic [2:0] cull,
    output logic [47:0] depth,  // the sort key, which has no place in the packet
    output splatline_pkg::footprint_t packet,
    output logic direction_valid,
    output logic direction_seen,  // the splat is not culled
    output logic [95:0] direction  // 3 x Q1.30, x in the lowest bits
);
  localparam BITS = splatline_setup_pkg::SLOT_BITS;
  localparam ROUND = splatline_setup_pkg::ROUND;
  localparam WORD = splatline_setup_pkg::WORD_BITS;
  localparam OUT_ROUND = splatline_setup_pkg::OUT_ROUND;
  localparam PAIR = splatline_setup_pkg::PAIR_BITS;
  localparam DIRECTS = splatline_setup_pkg::DIRECTS;
  // Packets that wait for colours, which depend on directions, are more.
  localparam PLACES = DIRECTS ? 32 : 8;

  generate
    if (CORES < 1 || CORES > 32) begin : gen_illegal
      $error("setup_unit: CORES from 1 to 32");
    end
  endgenerate

  // Constants: of the cores in a memory, of the units around them in registers.
  (* ram_style = "block", no_rw_check *) logic [81:0] constants[0:63];
  (* ram_style = "block", no_rw_check *) logic [63:0] starts[0:63];
  logic [15:0] eye_exponent, eye_top;
  logic [81:0] flags, near, far;
  always_ff @(posedge clk) begin
    if (constant_valid) begin
      if (!constant_index[6]) begin
        constants[constant_index[5:0]] <= {constant_exponent, constant_value};
        starts[constant_index[5:0]] <= constant_value;
      end
      case (constant_index)
        7'(splatline_setup_pkg::EYE_X): eye_exponent <= constant_exponent[15:0];
        7'(splatline_setup_pkg::EYE_Y): eye_top <= constant_exponent[15:0];
        7'(splatline_setup_pkg::FLAGS): flags <= {constant_exponent, constant_value};
        7'(splatline_setup_pkg::NEAR): near <= {constant_exponent, constant_value};
        7'(splatline_setup_pkg::FAR): far <= {constant_exponent, constant_value};
        default: ;
      endcase
    end
  end

  // Records: in every eighth cycle at most, as long as the coming round has a core without one.
  logic [2:0] phase;
  logic [5:0] loaded;
  logic load_side, taken, switches;
  logic beat_valid;
  logic [6:0] beat_place;
  logic [splatline_setup_pkg::BEAT_BITS-1:0] beat;
  assign record_ready = phase == 0 && loaded != 6'(CORES) && !switches;
  assign taken = record_valid && record_ready;
  setup_difference from_eye (
      .clk,
      .rst,
      .constant_valid,
      .constant_index,
      .constant_value,
      .eye_exponent,
      .eye_top,
      .valid(taken),
      .record,
      .place({load_side, loaded}),
      .beat_valid,
      .beat_place,
      .beat
  );

  // Rounds: which slot is issued, how many splats of each round there are.
  logic [7:0] cycle, next_cycle;
  logic [3:0] round;
  logic issues, waits;
  logic [5:0] batch;
  logic [6*(OUT_ROUND+1)-1:0] counts;
  logic [1:0] pending;
  logic [11:0] pending_count;
  logic drained, drain_side;
  // The next round's results go where those of the round before this one may still be.
  assign waits = cycle == 8'(ROUND - 1) && pending[!round[0]];
  always_comb begin
    next_cycle = waits ? cycle : cycle == 8'(ROUND - 1) ? 8'd0 : cycle + 1'b1;
    if (rst) next_cycle = 0;
  end
  always_ff @(posedge clk) begin
    phase <= phase + 1'b1;
    issues <= !waits;
    switches <= next_cycle == 8'(ROUND - splatline_setup_pkg::LOAD_AHEAD) && !waits;
    if (taken) loaded <= loaded + 1'b1;
    cycle <= next_cycle;
    if (switches) begin
      {batch, loaded} <= {loaded, 6'd0};
      load_side <= !load_side;
    end
    if (drained) pending[drain_side] <= 0;
    if (cycle == 8'(ROUND - 1) && !waits) begin
      round <= round + 1'b1;
      counts <= {counts[6*OUT_ROUND-1:0], batch};
    end
    if (issues && cycle == 8'(splatline_setup_pkg::OUT_LAST + 4) && counts[6*OUT_ROUND+:6] != 0) begin
      pending[round[0]] <= 1;
      if (round[0]) pending_count[11:6] <= counts[6*OUT_ROUND+:6];
      else pending_count[5:0] <= counts[6*OUT_ROUND+:6];
    end
    if (rst) begin
      {phase, loaded, round, batch, counts} <= 0;
      pending <= 0;
      load_side <= 1;
      issues <= 1;
    end
  end

  // The slots' pipeline, once for all cores.
  (* ram_style = "block" *) logic [BITS-1:0] words_of_program[0:255];
  initial for (int i = 0; i < 256; i = i + 1) words_of_program[i] = splatline_setup_pkg::microcode(8'(i));
  logic [BITS-1:0] read, stored;
  logic issued;
  splatline_setup_pkg::slot_t fetched, issue;
  logic [22*BITS-1:0] slots;
  logic [7:0] a_place, b_place, write_place;
  logic [21*8-1:0] result_places;
  logic [3:0] splat, leaving, second_splat;
  logic [81:0] constant1, constant2, constant3;
  logic [17:0] offset3;
  logic [32:0] right4;
  logic [63:0] start13, start14;
  splatline_setup_pkg::slot_t slot0, slot1, slot2, slot3, slot12, slot13, slot18, slot20;
  logic unread_a0, unread_b0, writes;
  logic [15:0] half19;
  logic [16:0] mask19;
  logic [3:0] rule_flags;
  logic other;
  logic [5:0] constant_place;
  logic [3:0] place_round;
  logic side;
  logic fetched_side;
  assign splat = place_round - fetched.round;
  // Results are those of an older splat than the slot's, in whose shadow they leave.
  assign leaving = place_round - 4'(OUT_ROUND);
  assign second_splat = fetched.out ? leaving : splat;
  // The program's memory is read a cycle ahead, since block RAM is slow, and has its register to itself; a pause is a
  // slot without effect.
  assign fetched = issued ? stored : {BITS{1'b0}};
  // Flags are the same for all splats.
  assign rule_flags = flags[3:0];
  assign other = fetched.by_flag && !rule_flags[fetched.flag];
  always_comb begin
    issue = fetched;
    if (other && fetched.b_constant)
      {issue.b_constant, issue.plain, issue.offset, issue.drop} = {1'b0, 1'b1, -8'sd31, 5'd0};
    else if (other) issue.a_constant = 1;
  end
  assign slot0 = slots[0+:BITS];
  assign slot1 = slots[1*BITS+:BITS];
  assign slot2 = slots[2*BITS+:BITS];
  assign slot3 = slots[3*BITS+:BITS];
  assign slot12 = slots[12*BITS+:BITS];
  assign slot13 = slots[13*BITS+:BITS];
  assign slot18 = slots[18*BITS+:BITS];
  assign slot20 = slots[20*BITS+:BITS];
  assign unread_a0 = slot0.a_constant || slot0.a_input;
  assign unread_b0 = !slot0.out && (slot0.b_constant || slot0.lookup != 0 || (slot0.plain && slot0.pick == 0));
  always_ff @(posedge clk) begin
    read <= words_of_program[next_cycle];
    stored <= read;
    issued <= issues;
    place_round <= round;
    fetched_side <= round[0];
    a_place <= other ? fetched.b + {4'd0, splat & fetched.b_turn} : fetched.a + {4'd0, splat & fetched.a_turn};
    b_place <= fetched.b + {4'd0, second_splat & fetched.b_turn};
    result_places <= {result_places[20*8-1:0], fetched.place + {4'd0, splat & fetched.place_turn}};
    write_place <= result_places[20*8+:8];
    writes <= slot20.write;
    slots <= {slots[21*BITS-1:0], issue};
    constant_place <= fetched.constant;
    side <= fetched_side;
    constant1 <= constants[constant_place];
    {constant2, constant3} <= {constant1, constant2};
    // The cores' common share of the exponents and of the right factor.
    offset3 <= ((slot2.b_constant && !slot2.plain) || slot2.pick != 0 ? constant2[81:64] : 18'd0) + 18'(slot2.offset);
    right4 <= slot3.plain && !slot3.entry ? 33'h80000000 : slot3.b_constant ? constant3[32:0] : 33'd0;
    start13 <= starts[slot12.start];
    start14 <= slot13.addend ? start13 : 64'd0;
    // A mantissa's rounding.
    half19 <= slot18.normal ? 16'd1 << slot18.drop : 16'd0;
    mask19 <= slot18.normal ? ~17'd1 << slot18.drop : ~17'd0;
  end

  // The cores, group after group: their steps, and the words that leave them.
  logic side1, side2;
  logic [5:0] drain_core;
  splatline_setup_pkg::step_t step;
  always_ff @(posedge clk) {side1, side2} <= {side, side1};
  assign step = {
    slots,
    unread_a0,
    unread_b0,
    a_place,
    b_place,
    writes,
    write_place,
    slot1.a_constant ? {constant1[81:64], constant1[32:0]} : 51'd0,
    constant3[32:0],
    offset3,
    right4,
    start14,
    half19,
    mask19,
    side,
    side2,
    beat_valid,
    beat_place[5:0],
    beat_place[6],
    phase - 3'd1,
    beat,
    drain_core,
    drain_side,
    phase
  };
  localparam GROUPS = (CORES + 3) / 4;
  localparam STEP = $bits(step);
  logic [(GROUPS+1)*STEP-1:0] steps;
  logic [(GROUPS+1)*WORD-1:0] words;
  assign steps[0+:STEP] = step;
  assign words[0+:WORD] = 0;
  genvar i;
  generate
    for (i = 0; i < GROUPS; i = i + 1) begin : gen_group
      setup_group #(
          .CORES(4 * i + 4 < CORES ? 4 : CORES - 4 * i)
      ) group (
          .clk,
          .step_in(steps[i*STEP+:STEP]),
          .step_out(steps[(i+1)*STEP+:STEP]),
          .word_in(words[i*WORD+:WORD]),
          .word_out(words[(i+1)*WORD+:WORD])
      );
    end
  endgenerate

  // Results leave core by core, a splat in eight cycles, if the queue has a place for its packet.
  logic draining, begins, free;
  logic [GROUPS+1:0] drain_valids;
  logic [5:0] drain_count;
  assign drain_count = drain_side ? pending_count[11:6] : pending_count[5:0];
  assign begins = phase == 0 && pending[drain_side] && free;
  assign drained = phase == 7 && draining && drain_core + 1'b1 == drain_count;
  always_ff @(posedge clk) begin
    if (begins) draining <= 1;
    if (phase == 7 && draining) begin
      draining <= 0;
      drain_core <= drained ? 6'd0 : drain_core + 1'b1;
    end
    // Rounds without splats leave no results.
    if (drained || (!pending[drain_side] && pending[!drain_side])) drain_side <= !drain_side;
    drain_valids <= {drain_valids[GROUPS:0], begins};
    if (rst) {draining, drain_core, drain_side, drain_valids} <= 0;
  end

  logic packed_valid;
  logic packed_taken;
  logic [2:0] packed_cull;
  logic [47:0] packed_depth;
  splatline_pkg::footprint_t packed_packet;
  logic [95:0] colour;
  // As far behind as the words that come through all groups, in a register of its own: it reaches every bit of them.
  logic [2:0] pack_phase;
  always_ff @(posedge clk) pack_phase <= phase - 3'(GROUPS + 1);
  setup_pack pack (
      .clk,
      .rst,
      .phase(pack_phase),
      .perspective(flags[0]),
      .by_opacity(flags[2]),
      .columns(flags[31:16]),
      .rows(flags[47:32]),
      .near_negative(near[63]),
      .near(near[62:0]),
      .near_leading(near[81:64]),
      .far_negative(far[63]),
      .far(far[62:0]),
      .far_leading(far[81:64]),
      .valid(drain_valids[GROUPS+1]),
      .word(words[GROUPS*WORD+:PAIR]),
      .packet_valid(packed_valid),
      .packet_taken(packed_taken),
      .colour,
      .cull(packed_cull),
      .depth(packed_depth),
      .packet(packed_packet)
  );

  // Colours pass by the cores.
  (* ram_style = "block", no_rw_check *) logic [95:0] colours[0:511];
  logic [95:0] colour_read;
  logic [8:0] colour_in, colour_out;
  always_ff @(posedge clk) begin
    if (taken) colours[colour_in] <= {record.blue, record.green, record.red};
    {colour_read, colour} <= {colours[colour_out], colour_read};
    if (taken) colour_in <= colour_in + 1'b1;
    if (packed_taken) colour_out <= colour_out + 1'b1;
    if (rst) {colour_in, colour_out} <= 0;
  end

  assign direction_valid = DIRECTS && packed_valid;
  assign direction_seen = DIRECTS && packed_cull == 0;
  generate
    if (DIRECTS) begin : gen_direction
      setup_direction directions (
          .clk,
          .phase(pack_phase),
          .perspective(flags[0]),
          .constant_valid,
          .constant_index,
          .constant_value(constant_value[31:0]),
          .word(words[GROUPS*WORD+PAIR+:33]),
          .direction
      );
    end else begin : gen_no_direction
      assign direction = 0;
    end
  endgenerate

  logic none;
  // Packets come in every eighth cycle at most.
  fifo #(
      .BITS(splatline_pkg::PACKET_BITS + 51),
      .PLACES(PLACES),
      .RESTS(1)
  ) queue (
      .clk,
      .rst,
      .claim(begins),
      .free,
      .none,
      .in_valid(packed_valid),
      .in({packed_cull, packed_depth, packed_packet}),
      .out_valid(packet_valid),
      .out_ready(packet_ready),
      .out({cull, depth, packet}),
      .next()
  );
endmodule
