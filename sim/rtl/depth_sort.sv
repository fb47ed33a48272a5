// Splats by the depth of their keys, nearest first; equal keys stay in the order in which they came, which is that of
// their numbers (src/footprint/depth.rs, and the stable order of src/front/order.rs).
//
//   taken one by one -> memory, region A, and counted by every digit -> for each digit:
//   sums of its counts, then all splats to their places in the other region
//
// A radix sort from the last digit to the first, over memory: what stays on the chip is a counter for every value of
// every digit. All digits are counted while the splats come, which is rarely enough that one memory takes the counts in
// turn. A digit that is the same in all keys moves nothing and gets no pass: in most scenes the first ones, since
// depths have few exponents. Why no merging network: docs/decisions/depth-order.md.
module depth_sort #(
    parameter DIGIT = 8,
    parameter COUNT_BITS = 24
) (
    input logic clk,
    input logic rst,
    input logic begins,  // a picture: counters are cleared
    input logic [31:0] base_a,
    input logic [31:0] base_b,
    input logic in_valid,
    output logic in_ready,
    input logic [127:0] in,  // the key is its lowest 48 bits
    input logic ends,  // no more will come
    // What reads a region: it begins on request and gives its words.
    output logic stream_begins,
    output logic [31:0] stream_first,
    output logic [31:0] stream_count,
    input logic splat_valid,
    output logic splat_ready,
    input logic [127:0] splat,
    output logic write_valid,
    input logic write_ready,
    output logic [31:0] write_address,
    output logic [127:0] write_word,
    input logic settled,  // nothing that was written is still on its way
    output logic done,
    output logic [COUNT_BITS-1:0] count,
    output logic [31:0] sorted  // where the splats are
);
  localparam KEY_BITS = 48;
  localparam PASSES = (KEY_BITS + DIGIT - 1) / DIGIT;
  localparam PASS_BITS = $clog2(PASSES + 1);
  localparam PLACE = PASS_BITS + DIGIT;

  generate
    if (DIGIT < 4 || DIGIT > 12) begin : gen_illegal
      $error("depth_sort: DIGIT from 4 to 12");
    end
  endgenerate

  typedef enum logic [2:0] {
    CLEAR,
    TAKE,
    SUM,
    BEGIN,
    MOVE,
    SETTLE,
    DONE
  } state_t;
  state_t state;
  logic [PASS_BITS-1:0] pass;
  logic side;  // splats are in region B

  function automatic logic [DIGIT-1:0] digit(input logic [KEY_BITS-1:0] key, input logic [PASS_BITS-1:0] number);
    digit = DIGIT'({{DIGIT{1'b0}}, key} >> (number * DIGIT));
  endfunction

  // Counters of all digits' values, which become places. Block RAM is slow: what is read has a register of its own
  // before anything is made of it.
  (* ram_style = "block", no_rw_check *) logic [COUNT_BITS-1:0] counters[0:(1<<PLACE)-1];
  logic [COUNT_BITS-1:0] counter_read, counter_found, counter, changed, after;

  // Counters on their way: one is asked for, waits for its word, is next, and changes. One that any of the three before
  // it changes was read too early, and takes what they made of it. Of those, the one right before it changes in the
  // last moment.
  logic asks, waiting, next, changing, moved, moves, changes;
  logic [PLACE-1:0] read_place, waiting_place, next_place, changing_place, moved_place, changed_place;
  logic follows_last_but_one, follows, changed_meanwhile;
  logic [COUNT_BITS-1:0] moved_after, meanwhile;
  assign follows_last_but_one = changing && waiting_place == changing_place;
  // One addition for all counts.
  assign after = counter + 1'b1;
  always_ff @(posedge clk) begin
    if (moves) begin
      counter_read <= counters[read_place];
      counter_found <= counter_read;
      counter <= follows ? after : changed_meanwhile ? meanwhile : counter_found;
      {waiting, next, changing, moved} <= {asks, waiting, next, changing};
      {waiting_place, next_place} <= {read_place, waiting_place};
      {changing_place, moved_place} <= {next_place, changing_place};
      moved_after <= after;
      follows <= next && waiting_place == next_place;
      changed_meanwhile <= follows_last_but_one || (moved && waiting_place == moved_place);
      meanwhile <= follows_last_but_one ? after : moved_after;
    end
    if (changes) counters[changed_place] <= changed;
  end

  // A splat that was taken is counted digit by digit.
  logic [PASS_BITS:0] step;
  logic [KEY_BITS-1:0] key;
  assign in_ready = state == TAKE && step == 0 && write_ready;

  // Values of a digit, one after the other, from one cycle to the next.
  logic [PLACE:0] value;
  logic [COUNT_BITS-1:0] sum;
  logic same_for_all;

  // Splats on their way to their places, beside their counters.
  logic [127:0] waiting_splat, next_splat, changing_splat;
  logic [COUNT_BITS-1:0] left;
  always_ff @(posedge clk)
    if (moves) {waiting_splat, next_splat, changing_splat} <= {splat, waiting_splat, next_splat};
  logic rests;  // nothing is on its way
  assign rests = !waiting && !next && !changing;
  assign moves = state != MOVE || !changing || write_ready;
  assign splat_ready = state == MOVE && moves;

  always_comb begin
    asks = 0;
    read_place = {pass, digit(splat[KEY_BITS-1:0], pass)};
    changes = changing && moves;
    changed_place = changing_place;
    changed = after;
    case (state)
      CLEAR: begin
        changes = 1;
        changed_place = value[PLACE-1:0];
        changed = 0;
      end
      TAKE: begin
        asks = step != 0 && step <= (PASS_BITS + 1)'(PASSES);
        read_place = {PASS_BITS'(step - 1'b1), digit(key, PASS_BITS'(step - 1'b1))};
      end
      SUM: begin
        asks = !value[DIGIT];
        read_place = {pass, value[DIGIT-1:0]};
        changed = sum;
      end
      MOVE: asks = splat_valid;
      default: ;
    endcase
  end

  assign write_valid = (state == TAKE && step == 0 && in_valid) || (state == MOVE && changing);
  assign write_address = (state == TAKE || side ? base_a : base_b) + (state == TAKE ? 32'(count) : 32'(counter));
  assign write_word = state == TAKE ? in : changing_splat;
  assign stream_begins = state == BEGIN;
  assign stream_first = side ? base_b : base_a;
  assign stream_count = 32'(count);
  assign sorted = stream_first;
  assign done = state == DONE;

  always_ff @(posedge clk) begin
    case (state)
      CLEAR: begin
        value <= value + 1'b1;
        if (value[PLACE-1:0] == {PLACE{1'b1}}) state <= TAKE;
        {side, pass, step} <= 0;
      end
      TAKE: begin
        if (step != 0) step <= step == (PASS_BITS + 1)'(PASSES + 1) ? '0 : step + 1'b1;
        if (in_valid && in_ready) begin
          key <= in[KEY_BITS-1:0];
          count <= count + 1'b1;
          step <= 1;
        end else if (ends && !in_valid && step == 0 && rests) state <= count == 0 ? DONE : SUM;
        value <= 0;
        {sum, same_for_all} <= 0;
      end
      // What was written comes to rest meanwhile.
      SUM: begin
        if (!value[DIGIT]) value <= value + 1'b1;
        if (changing) begin
          sum <= sum + counter;
          if (counter == count) same_for_all <= 1;
        end
        if (value[DIGIT] && rests && settled) begin
          state <= same_for_all ? SETTLE : BEGIN;
          left <= count;
        end
      end
      BEGIN: state <= MOVE;
      MOVE: begin
        if (changing && write_ready) begin
          left <= left - 1'b1;
          if (left == 1) begin
            state <= SETTLE;
            side <= !side;
          end
        end
      end
      SETTLE: begin
        if (settled) begin
          value <= 0;
          {sum, same_for_all} <= 0;
          pass <= pass + 1'b1;
          state <= pass == PASS_BITS'(PASSES - 1) ? DONE : SUM;
        end
      end
      default: ;
    endcase
    if (begins || rst) begin
      state <= rst ? DONE : CLEAR;
      {value, count} <= 0;
    end
  end
endmodule
