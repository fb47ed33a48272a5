// What row_window.sv promises, whatever span comes: a run has a pixel at least, and all of them lie in the window. Its
// user's side of the bargain is assumed: columns of the box that lie in the window, at least one, within one tile.
// Included in the module where FORMAL is defined (`rtl -- formal`).

  logic [2:0] passed;
  logic [COLUMN_BITS-1:0] first18, first19, first20;
  logic [15:0] last_before;
  logic [COLUMN_BITS:0] beyond18, beyond19, beyond20;
  assign last_before = end_column - 16'd1;
  initial passed = 0;
  always_ff @(posedge clk) begin
    passed <= {passed[1:0], 1'b1};
    first18 <= start_column[COLUMN_BITS-1:0];
    first19 <= first18;
    first20 <= first19;
    // One more than the window's last column, counted within the tile.
    beyond18 <= {1'b0, last_before[COLUMN_BITS-1:0]} + 1'b1;
    beyond19 <= beyond18;
    beyond20 <= beyond19;
  end

  always_comb begin
    assume (start_column < end_column);
    assume (start_column[15:COLUMN_BITS] == last_before[15:COLUMN_BITS]);
  end

  always_comb
    if (passed[2] && holds20) begin
      assert (count20 != 0);
      assert (column20 >= first20);
      assert ({1'b0, column20} + count20 <= beyond20);
    end
