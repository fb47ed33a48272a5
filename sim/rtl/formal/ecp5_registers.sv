// What `move_in` of sim/rtl/cosim/src/registers.rs is tried with: a circuit, and an ECP5's multiplier and block RAM
// with their registers, as Lattice's TN1267 and TN1264 describe them (with one clock, without resets, and 36 bits
// wide).

`ifndef SIMULATED
module registers_subject (
    input logic clk,
    input logic rst,
    input logic advance,
    input logic [32:0] left,
    input logic [17:0] right,
    output logic [50:0] product,
    output logic [35:0] word
);
  logic [32:0] left1;
  logic [17:0] right1;
  always_ff @(posedge clk) if (advance) {left1, right1} <= {left, right};
  multiply #(.LEFT(33), .RIGHT(18)) multiplied (.clk, .advance, .left(left1), .right(right1), .product);
  delay #(.BITS(36), .STAGES(20)) delayed (.clk, .rst, .advance, .in({left[17:0], right}), .out(word));
endmodule

`else
module modelled_multiplier #(
    parameter REG_INPUTA_CLK = "NONE",
    parameter REG_INPUTA_CE = "CE0",
    parameter REG_INPUTB_CLK = "NONE",
    parameter REG_INPUTB_CE = "CE0",
    parameter REG_OUTPUT_CLK = "NONE"
) (
    input A0, A1, A2, A3, A4, A5, A6, A7, A8, A9, A10, A11, A12, A13, A14, A15, A16, A17,
    input B0, B1, B2, B3, B4, B5, B6, B7, B8, B9, B10, B11, B12, B13, B14, B15, B16, B17,
    input C0, C1, C2, C3, C4, C5, C6, C7, C8, C9, C10, C11, C12, C13, C14, C15, C16, C17,
    input SIGNEDA, SIGNEDB, SOURCEA, SOURCEB, CLK0, CE0, CE1, CE2, CE3,
    output P0, P1, P2, P3, P4, P5, P6, P7, P8, P9, P10, P11, P12, P13, P14, P15, P16, P17,
    output P18, P19, P20, P21, P22, P23, P24, P25, P26, P27, P28, P29, P30, P31, P32, P33, P34, P35
);
  wire [17:0] a = {A17, A16, A15, A14, A13, A12, A11, A10, A9, A8, A7, A6, A5, A4, A3, A2, A1, A0};
  wire [17:0] b = {B17, B16, B15, B14, B13, B12, B11, B10, B9, B8, B7, B6, B5, B4, B3, B2, B1, B0};
  wire [3:0] enables = {CE3, CE2, CE1, CE0};
  // The last letter of CE0 to CE3.
  localparam integer ENABLE_A = REG_INPUTA_CE & 3;
  localparam integer ENABLE_B = REG_INPUTB_CE & 3;
  reg [17:0] held_a, held_b;
  reg [35:0] held_product;
  wire [17:0] factor_a = REG_INPUTA_CLK == "CLK0" ? held_a : a;
  wire [17:0] factor_b = REG_INPUTB_CLK == "CLK0" ? held_b : b;
  wire [35:0] product = factor_a * factor_b;
  always @(posedge CLK0) begin
    if (enables[ENABLE_A]) held_a <= a;
    if (enables[ENABLE_B]) held_b <= b;
    if (CE0) held_product <= product;
  end
  assign {P35, P34, P33, P32, P31, P30, P29, P28, P27, P26, P25, P24, P23, P22, P21, P20, P19, P18, P17, P16, P15, P14, P13, P12, P11, P10, P9, P8, P7, P6, P5,
          P4, P3, P2, P1, P0} = REG_OUTPUT_CLK == "CLK0" ? held_product : product;
endmodule

module modelled_memory #(
    parameter DATA_WIDTH_A = 36,
    parameter DATA_WIDTH_B = 36,
    parameter REGMODE_A = "NOREG",
    parameter REGMODE_B = "NOREG"
) (
    input CLKA, CEA, WEA, OCEA, RSTA, CSA0, CSA1, CSA2, CLKB, CEB, WEB, OCEB, RSTB, CSB0, CSB1, CSB2,
    input ADA0, ADA1, ADA2, ADA3, ADA4, ADA5, ADA6, ADA7, ADA8, ADA9, ADA10, ADA11, ADA12, ADA13,
    input ADB0, ADB1, ADB2, ADB3, ADB4, ADB5, ADB6, ADB7, ADB8, ADB9, ADB10, ADB11, ADB12, ADB13,
    input DIA0, DIA1, DIA2, DIA3, DIA4, DIA5, DIA6, DIA7, DIA8, DIA9, DIA10, DIA11, DIA12, DIA13, DIA14, DIA15, DIA16, DIA17,
    input DIB0, DIB1, DIB2, DIB3, DIB4, DIB5, DIB6, DIB7, DIB8, DIB9, DIB10, DIB11, DIB12, DIB13, DIB14, DIB15, DIB16, DIB17,
    output DOA0, DOA1, DOA2, DOA3, DOA4, DOA5, DOA6, DOA7, DOA8, DOA9, DOA10, DOA11, DOA12, DOA13, DOA14, DOA15, DOA16, DOA17,
    output DOB0, DOB1, DOB2, DOB3, DOB4, DOB5, DOB6, DOB7, DOB8, DOB9, DOB10, DOB11, DOB12, DOB13, DOB14, DOB15, DOB16, DOB17
);
  reg [35:0] memory[0:511];
  reg [35:0] word, held;
  wire [8:0] written = {ADA13, ADA12, ADA11, ADA10, ADA9, ADA8, ADA7, ADA6, ADA5};
  wire [8:0] read = {ADB13, ADB12, ADB11, ADB10, ADB9, ADB8, ADB7, ADB6, ADB5};
  wire [35:0] in = {DIB17, DIB16, DIB15, DIB14, DIB13, DIB12, DIB11, DIB10, DIB9, DIB8, DIB7, DIB6, DIB5, DIB4, DIB3, DIB2, DIB1, DIB0,
                    DIA17, DIA16, DIA15, DIA14, DIA13, DIA12, DIA11, DIA10, DIA9, DIA8, DIA7, DIA6, DIA5, DIA4, DIA3, DIA2, DIA1, DIA0};
  always @(posedge CLKA) begin
    if (CEA && WEA && ADA0) memory[written][8:0] <= in[8:0];
    if (CEA && WEA && ADA1) memory[written][17:9] <= in[17:9];
    if (CEA && WEA && ADA2) memory[written][26:18] <= in[26:18];
    if (CEA && WEA && ADA3) memory[written][35:27] <= in[35:27];
  end
  always @(posedge CLKB) begin
    if (CEB) word <= memory[read];
    if (OCEB) held <= word;
  end
  assign {DOB17, DOB16, DOB15, DOB14, DOB13, DOB12, DOB11, DOB10, DOB9, DOB8, DOB7, DOB6, DOB5, DOB4, DOB3, DOB2, DOB1, DOB0,
          DOA17, DOA16, DOA15, DOA14, DOA13, DOA12, DOA11, DOA10, DOA9, DOA8, DOA7, DOA6, DOA5, DOA4, DOA3, DOA2, DOA1, DOA0} = REGMODE_B == "OUTREG" ? held : word;
  initial if (DATA_WIDTH_A != 36 || DATA_WIDTH_B != 36) $display("a memory of another width");
endmodule

// Both netlists from the same random inputs, with random pauses.
module registers_bench;
  reg clk = 0, rst = 1, advance = 0;
  reg [32:0] left = 0;
  reg [17:0] right = 0;
  wire [50:0] product_before, product_after;
  wire [35:0] word_before, word_after;
  registers_outside first (.clk(clk), .rst(rst), .advance(advance), .left(left), .right(right), .product(product_before), .word(word_before));
  registers_inside second (.clk(clk), .rst(rst), .advance(advance), .left(left), .right(right), .product(product_after), .word(word_after));
  integer cycle, compared = 0, wrong = 0;
  initial begin
    for (cycle = 0; cycle < 1100; cycle = cycle + 1) begin
      rst = cycle < 3;
      advance = cycle < 3 || $urandom % 4 != 0;
      left = {$urandom, $urandom};
      right = $urandom;
      #1 clk = 1;
      #1 clk = 0;
      if (cycle > 100) begin
        compared = compared + 1;
        if (product_before !== product_after || word_before !== word_after || ^product_before === 1'bx || ^word_before === 1'bx) wrong = wrong + 1;
      end
    end
    $display("%0d cycles, %0d wrong", compared, wrong);
  end
endmodule
`endif
