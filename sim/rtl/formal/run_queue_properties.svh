// What run_queue.sv promises, for every sequence of runs and takers: nothing is lost, doubled, overwritten or changed,
// runs keep their order, and a run that waits stays. One run, chosen freely, is followed on its way; what holds for it
// holds for all. Included in the module where FORMAL is defined (`rtl -- formal`).

  (* anyseq *) logic follow;

  logic followed, gone, started, waited, foretold;
  logic [BITS:0] before, front;
  logic [$bits(in_run)-1:0] entry, waiting;
  logic [BITS-1:0] spot;
  logic [$clog2(SLOTS)-1:0] number, length;
  assign front = {{BITS{1'b0}}, out_valid};
  assign spot = head[BITS-1:0] + BITS'(before - front);
  assign length = tail - head;
  initial started = 0;

  always_ff @(posedge clk) begin
    started <= 1;
    foretold <= ready_next;
    if (rst) begin
      followed <= 0;
      gone <= 0;
      waited <= 0;
    end else begin
      waited <= out_valid && !out_ready;
      waiting <= out_run;
      if (put && follow && !followed) begin
        followed <= 1;
        before <= count + front - {{BITS{1'b0}}, out_valid && out_ready};
        entry <= in_run;
        number <= in_slot;
      end else if (followed && !gone && out_valid && out_ready) begin
        if (before == 0) gone <= 1;
        else before <= before - 1'b1;
      end
    end
  end

  always_comb if (!started) assume (rst);

  always_comb
    if (started) begin
      assert (count <= DEPTH);
      assert (some == (count != 0) && full == (count == DEPTH));
      assert ({{BITS{1'b0}}, length} == {{$clog2(SLOTS) - 1{1'b0}}, count});
      assert (in_ready == (count != DEPTH) && in_ready == foretold);
      assert (empty == (count == 0 && !out_valid));
      if (waited) assert (out_valid && out_run == waiting);
      if (followed && !gone) begin
        assert (before < count + front);
        if (before == 0 && out_valid) assert (out_run == entry && out_slot == number);
        else assert (memory[spot] == entry && $clog2(SLOTS)'(head + (before - front)) == number);
      end
    end
