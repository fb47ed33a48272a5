// A footprint's box cut to the window: its first visible row and how many there are, and the columns of both.
//
// Whatever box comes, the rows that leave this unit lie in the window, and where there is one, the columns do and there is one of them at least, which is what
// row_window.sv is promised (proven, `formal/visible_box_properties.svh`).
//
//   23 what is visible | 24 how many rows: none, if the window holds none of the box's columns
module visible_box (
    input logic clk,
    input splatline_pkg::window_t window,
    // In stage 22: the box.
    input logic [15:0] first_row22,
    input logic [15:0] end_row22,
    input logic [15:0] box_first22,
    input logic [15:0] box_end22,
    output logic [15:0] row24,
    output logic [15:0] rows24,
    output logic [15:0] first_column24,
    output logic [15:0] end_column24,
    output logic [15:0] box_first24,
    output logic [15:0] box_end24
);
  logic [15:0] row23, end_row23, first_column23, end_column23, box_first23, box_end23;
  always_ff @(posedge clk) begin
    row23 <= first_row22 > window.first_row ? first_row22 : window.first_row;
    end_row23 <= end_row22 < window.end_row ? end_row22 : window.end_row;
    first_column23 <= box_first22 > window.first_column ? box_first22 : window.first_column;
    end_column23 <= box_end22 < window.end_column ? box_end22 : window.end_column;
    box_first23 <= box_first22;
    box_end23 <= box_end22;

    row24 <= row23;
    rows24 <= first_column23 < end_column23 && row23 < end_row23 ? end_row23 - row23 : 16'd0;
    first_column24 <= first_column23;
    end_column24 <= end_column23;
    box_first24 <= box_first23;
    box_end24 <= box_end23;
  end

`ifdef FORMAL
`include "formal/visible_box_properties.svh"
`endif
endmodule
