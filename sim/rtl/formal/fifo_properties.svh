// What fifo.sv promises, for every sequence of claims, arrivals and takers: nothing is lost, doubled, overwritten or
// changed, entries keep their order, an entry that waits stays, a place is claimed if and only if there is one, and
// `next` is what comes.
//
// Its user's side of the bargain is assumed: a claim only where `free` is set, each part of an entry only for a place
// claimed before, and the last part not before the others. One entry, chosen freely, is followed on its way from its
// last part on, and what was written last to one place, chosen freely, of each part; what holds for them holds for
// all. Included in the module where FORMAL is defined (`rtl -- formal`).

  (* anyseq *) logic follow;

  // Claimed and not yet in; entries in memory, and with the word and the register.
  logic [INDEX:0] coming, stored, held, ahead;
  logic last_in;
  assign last_in = in_valid[PARTS-1];
  logic [INDEX+1:0] total;
  assign total = {1'b0, coming} + {1'b0, held};
  assign stored = tail - head;
  assign ahead = {{INDEX{1'b0}}, out_valid} + {{INDEX{1'b0}}, word_valid};
  assign held = stored + ahead;

  // The entry that is followed: how many are before it, and what it is.
  logic followed, gone, started, waited;
  logic [INDEX:0] before;
  logic [BITS-1:0] entry, waiting, arriving, stored_entry, stored_word;
  logic [INDEX-1:0] spot;
  assign spot = head[INDEX-1:0] + INDEX'(before - ahead);
  initial started = 0;

  // Each part's words in memory, and how many are there of entries that are not yet in. Of an early part the entry has
  // what came for its place.
  (* anyconst *) logic [INDEX-1:0] watched;
  genvar q;
  generate
    for (q = 0; q < PARTS; q = q + 1) begin : gen_early
      localparam END = gen_part[q].END;
      localparam FIRST = gen_part[q].FIRST;
      logic [INDEX:0] place, early, unclaimed;
      logic [END-FIRST-1:0] written;
      logic seen;
      // What lies in the part's memory at three places.
      logic [END-FIRST-1:0] at_tail, at_spot, at_watched;
      if (SEEN[q]) begin : gen_seen
        logic [END-FIRST-1:0] foretold;
        assign at_tail = gen_part[q].gen_tables.memory[tail[INDEX-1:0]];
        assign at_spot = gen_part[q].gen_tables.memory[spot];
        assign at_watched = gen_part[q].gen_tables.memory[watched];
        always_ff @(posedge clk) foretold <= next[END-1:FIRST];
        always_comb if (started) assert (out[END-1:FIRST] == foretold);
      end else begin : gen_unseen
        assign at_tail = gen_part[q].gen_block.memory[tail[INDEX-1:0]];
        assign at_spot = gen_part[q].gen_block.memory[spot];
        assign at_watched = gen_part[q].gen_block.memory[watched];
      end
      assign place = gen_part[q].place;
      assign early = place - tail;
      assign arriving[END-1:FIRST] = early == 0 ? in[END-1:FIRST] : at_tail;
      assign stored_entry[END-1:FIRST] = at_spot;
      assign stored_word[END-1:FIRST] = gen_part[q].word;
      always_ff @(posedge clk) begin
        if (rst) begin
          unclaimed <= 0;
          seen <= 0;
        end else begin
          unclaimed <= unclaimed + {{INDEX{1'b0}}, claim} - {{INDEX{1'b0}}, in_valid[q]};
          if (in_valid[q] && place[INDEX-1:0] == watched) begin
            seen <= 1;
            written <= in[END-1:FIRST];
          end
        end
      end
      always_comb
        if (started && !rst) begin
          assume (!in_valid[q] || unclaimed != 0);
          assume (!last_in || in_valid[q] || early != 0);
        end
      always_comb
        if (started) begin
          assert (early <= coming && unclaimed == coming - early);
          if (seen) assert (at_watched == written);
        end
    end
  endgenerate

  always_ff @(posedge clk) begin
    started <= 1;
    if (rst) begin
      coming <= 0;
      followed <= 0;
      gone <= 0;
      waited <= 0;
    end else begin
      coming <= coming + {{INDEX{1'b0}}, claim} - {{INDEX{1'b0}}, last_in};
      waited <= out_valid && !out_ready;
      waiting <= out;
      if (last_in && follow && !followed) begin
        followed <= 1;
        before <= held - {{INDEX{1'b0}}, out_valid && out_ready};
        entry <= arriving;
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
        if (before >= ahead) assert (stored_entry == entry);
        else if (before == 0 && out_valid) assert (out == entry);
        else assert (stored_word == entry);
      end
    end
