// What visible_box.sv promises for every box and every window: rows and columns that lie in the window and in the box. Nothing is assumed of either. Included in
// the module where FORMAL is defined (`rtl -- formal`).

  logic [1:0] passed;
  splatline_pkg::window_t window23, window24;
  logic [15:0] first_row23, end23, first_row24, end24;
  initial passed = 0;
  always_ff @(posedge clk) begin
    passed <= {passed[0], 1'b1};
    window23 <= window;
    window24 <= window23;
    first_row23 <= first_row22;
    end23 <= end_row22;
    first_row24 <= first_row23;
    end24 <= end23;
  end

  always_comb
    if (passed[1] && rows24 != 0) begin
      assert (row24 >= window24.first_row && row24 >= first_row24);
      assert ({1'b0, row24} + {1'b0, rows24} <= {1'b0, window24.end_row});
      assert ({1'b0, row24} + {1'b0, rows24} <= {1'b0, end24});
      assert (first_column24 < end_column24);
      assert (first_column24 >= window24.first_column && end_column24 <= window24.end_column);
      assert (box_first24 <= first_column24 && end_column24 <= box_end24);
    end
