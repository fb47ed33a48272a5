// What fifo.sv promises, for every sequence of claims, arrivals and takers: nothing is lost, doubled, overwritten or changed, entries keep
// their order, an entry that waits stays, and a place is claimed if and only if there is one.
//
// Its user's side of the bargain is assumed: a claim only where `free` is set, and an entry only for a place claimed before. One entry, chosen
// freely, is followed on its way; what holds for it holds for all. Included in the module where FORMAL is defined (`rtl -- formal`).

  (* anyseq *) logic follow;

  // Claimed and not yet in; entries in memory, and with the word and the register.
  logic [INDEX:0] coming, stored, held, ahead;
  logic [INDEX+1:0] total;
  assign total = {1'b0, coming} + {1'b0, held};
  assign stored = tail - head;
  assign ahead = {{INDEX{1'b0}}, out_valid} + {{INDEX{1'b0}}, word_valid};
  assign held = stored + ahead;

  // The entry that is followed: how many are before it, and what it is.
  logic followed, gone, started, waited;
  logic [INDEX:0] before;
  logic [BITS-1:0] entry, waiting;
  logic [INDEX-1:0] spot;
  assign spot = head[INDEX-1:0] + INDEX'(before - ahead);
  initial started = 0;

  always_ff @(posedge clk) begin
    started <= 1;
    if (rst) begin
      coming <= 0;
      followed <= 0;
      gone <= 0;
      waited <= 0;
    end else begin
      coming <= coming + {{INDEX{1'b0}}, claim} - {{INDEX{1'b0}}, in_valid};
      waited <= out_valid && !out_ready;
      waiting <= out;
      if (in_valid && follow && !followed) begin
        followed <= 1;
        before <= held - {{INDEX{1'b0}}, out_valid && out_ready};
        entry <= in;
      end else if (followed && !gone && out_valid && out_ready) begin
        if (before == 0) gone <= 1;
        else before <= before - 1'b1;
      end
    end
  end

  always_comb begin
    if (!started) assume (rst);
    if (started && !rst) begin
      assume (!claim || free);
      assume (!in_valid || coming != 0);
    end
  end

  always_comb
    if (started) begin
      assert ({1'b0, claimed} == total);
      assert (claimed <= PLACES);
      assert (free == (claimed != PLACES));
      assert (none == (claimed == 0));
      assert (stored <= PLACES && coming <= PLACES && held <= PLACES);
      if (waited) assert (out_valid && out == waiting);
      if (followed && !gone) begin
        assert (before < held);
        if (before >= ahead) assert (memory[spot] == entry);
        else if (before == 0 && out_valid) assert (out == entry);
        else assert (word == entry);
      end
    end
