// What visible_box.sv promises for every box and every window: rows and columns that lie in the window and in the box.
// Of the window it is assumed that it lies in one tile, of the box nothing. Included in the module where FORMAL is
// defined (`rtl -- formal`).

  logic [1:0] passed;
  splatline_pkg::window_t window2, window3;
  logic [15:0] full3, last_before, first_row2, end2, first_row3, end3, box_first2, box_end2, box_first3, box_end3;
  initial passed = 0;
  always_ff @(posedge clk) begin
    passed <= {passed[0], 1'b1};
    window2 <= window;
    window3 <= window2;
    first_row2 <= first_row1;
    end2 <= end_row1;
    first_row3 <= first_row2;
    end3 <= end2;
    full3 <= row2;
    box_first2 <= box_first1;
    box_end2 <= box_end1;
    box_first3 <= box_first2;
    box_end3 <= box_end2;
  end

  assign last_before = window.end_row - 16'd1;
  always_comb assume (window.first_row > last_before || window.first_row[15:ROW_BITS] == last_before[15:ROW_BITS]);

  always_comb
    if (passed[1] && rows3 != 0) begin
      assert (row3 == full3[ROW_BITS-1:0]);
      assert (full3 >= window3.first_row && full3 >= first_row3);
      assert ({1'b0, full3} + rows3 <= {1'b0, window3.end_row});
      assert ({1'b0, full3} + rows3 <= {1'b0, end3});
      assert (start_column3 < end_column3);
      assert (start_column3 >= window3.first_column && end_column3 <= window3.end_column);
      assert (box_first3 <= start_column3 && end_column3 <= box_end3);
    end
