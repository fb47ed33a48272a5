// What lane.sv promises: every pixel of a run is visited once, in order, and no other place, so that a run within the
// window stays there; and no place is visited again before its last value is written; runs begin two moves apart at
// least, which run_paint.sv counts on. Its user's side of the bargain is assumed: runs have a pixel at least, end
// within the tile's columns, and stay until they are taken. Included in the module where FORMAL is defined (`rtl --
// formal`).

  logic started, waited, began;
  logic [PLACE-1:0] place, waiting;
  logic [COLUMN_BITS:0] beyond, length;
  initial started = 0;
  always_ff @(posedge clk) begin
    started <= 1;
    waited <= run_valid && !run_ready && !rst;
    waiting <= first;
    length <= run.count;
    began <= rst ? 1'b0 : advance ? run_ready : began;
    if (advance && last) begin
      place <= first;
      beyond <= {1'b0, run.column} + run.count;
    end
  end

  // A place, chosen freely, and the moves of the lane since it was visited last.
  (* anyconst *) logic [PLACE-1:0] watched;
  logic [2:0] since;
  logic visited;
  assign visited = active && address == watched;
  always_ff @(posedge clk) begin
    if (rst) since <= 7;
    else if (advance) since <= visited ? 3'd1 : since == 7 ? 3'd7 : since + 3'd1;
  end

  always_comb begin
    if (!started) assume (rst);
    assume (run.count != 0 && {1'b0, run.column} + run.count <= (1 << COLUMN_BITS));
    if (waited) assume (run_valid && first == waiting && run.count == length);
  end

  // Is the watched place in what is left of the run, or in the run to come, and how many pixels ahead?
  logic at_rest, in_run;
  logic [COLUMN_BITS-1:0] rest_ahead, run_ahead;
  assign rest_ahead = watched[COLUMN_BITS-1:0] - at.column;
  assign run_ahead = watched[COLUMN_BITS-1:0] - run.column;
  assign at_rest = active && at.row == watched[PLACE-1:COLUMN_BITS] && watched[COLUMN_BITS-1:0] >= at.column && {1'b0, rest_ahead} < at.count;
  assign in_run = run.row == watched[PLACE-1:COLUMN_BITS] && watched[COLUMN_BITS-1:0] >= run.column && {1'b0, run_ahead} < run.count;

  // What induction has to know of the places that were left: each of them is the watched one if and only if that was
  // left so long ago.
  genvar age;
  generate
    for (age = 0; age < LEFT; age = age + 1) begin : gen_age
      always_comb
        if (started && left_valid[age] && left[PLACE*age+:PLACE] == watched) assert (since <= age + 1);
      always_comb if (started && since == age + 1) assert (left_valid[age] && left[PLACE*age+:PLACE] == watched);
    end
  endgenerate

  always_comb
    if (started) begin
      if (active) begin
        assert (at.row == place[PLACE-1:COLUMN_BITS]);
        assert (at.count != 0 && at.count <= (1 << COLUMN_BITS));
        assert (at.column >= place[COLUMN_BITS-1:0]);
        assert ({1'b0, at.column} + at.count == beyond);
        assert (beyond <= (1 << COLUMN_BITS));
        assert (final_pixel == (at.count == 1));
      end
      assert (last == (!active || final_pixel));
      if (apart) assert (run_valid);
      if (began) assert (!apart);
      assert (since != 0);
      if (visited) assert (since >= INTERVAL);
      // What is left of the run, and the run to come if it may begin now, keep their distance from the watched place.
      if (at_rest) assert ({3'b0, since} + {3'b0, rest_ahead} >= INTERVAL);
      if (apart && in_run) assert ((visited ? 6'd0 : {3'b0, since}) + {3'b0, run_ahead} + 6'd1 >= INTERVAL);
    end
