// What visible_box.sv promises for every box and every window: rows and columns that lie in the window and in the box. Nothing is assumed of either. Included in
// the module where FORMAL is defined (`rtl -- formal`).

  logic [1:0] passed;
  splatline_pkg::window_t window2, window3;
  logic [15:0] first_row2, end2, first_row3, end3;
  initial passed = 0;
  always_ff @(posedge clk) begin
    passed <= {passed[0], 1'b1};
    window2 <= window;
    window3 <= window2;
    first_row2 <= first_row1;
    end2 <= end_row1;
    first_row3 <= first_row2;
    end3 <= end2;
  end

  always_comb
    if (passed[1] && rows3 != 0) begin
      assert (row3 >= window3.first_row && row3 >= first_row3);
      assert ({1'b0, row3} + {1'b0, rows3} <= {1'b0, window3.end_row});
      assert ({1'b0, row3} + {1'b0, rows3} <= {1'b0, end3});
      assert (first_column3 < end_column3);
      assert (first_column3 >= window3.first_column && end_column3 <= window3.end_column);
      assert (box_first3 <= first_column3 && end_column3 <= box_end3);
    end
