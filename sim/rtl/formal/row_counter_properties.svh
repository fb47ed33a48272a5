// What row_counter.sv promises for every sequence of splats and places: the rows of a splat, each once and in order,
// and before the next splat is taken. So rows that lie in a window stay there. Its user's side of the bargain is
// assumed: a splat's rows lie in the tile (visible_box.sv). Included in the module where FORMAL is defined (`rtl --
// formal`).

  logic started;
  logic [COUNT-1:0] begun, all, issued;
  initial started = 0;
  always_ff @(posedge clk) begin
    started <= 1;
    if (splat_ready) begin
      begun <= {1'b0, first};
      all <= rows;
      issued <= 0;
    end else if (issue) issued <= issued + 1'b1;
  end

  always_comb begin
    if (!started) assume (rst);
    assume ({2'b00, first} + {1'b0, rows} <= (COUNT + 1)'(1 << (COUNT - 1)));
  end

  always_comb
    if (started && busy) begin
      assert ({1'b0, begun} + {1'b0, all} <= (COUNT + 1)'(1 << (COUNT - 1)));
      assert ({1'b0, row} == begun + issued);
      assert (left == all - issued);
      assert (some == (all != 0));
      assert (last == (left <= 1));
      if (all != 0) begin
        assert (issued < all);
        assert ({2'b00, row} < {1'b0, begun} + {1'b0, all});
        if (splat_ready) assert (issued == all - 1'b1);
      end else assert (issued == 0 && (!issue || splat_ready));
    end
