// left * right + ADD, two cycles later, unsigned: products of 18-bit parts in the first, their sum in the second.
//
// A multiplier of a board has some 18 bits; a wider product in one cycle would chain several of them and an adder. The addend is the
// half that rounds. Parts of one or two bits (a fraction whose 1.0 is a value has a bit more than its multiplier) are gates.
module multiply #(
    parameter LEFT = 18,
    parameter RIGHT = 18,
    parameter [LEFT+RIGHT-1:0] ADD = 0
) (
    input logic clk,
    input logic advance,
    input logic [LEFT-1:0] left,
    input logic [RIGHT-1:0] right,
    output logic [LEFT+RIGHT-1:0] product
);
  localparam PART = 18;
  localparam ROWS = (LEFT + PART - 1) / PART;
  localparam COLUMNS = (RIGHT + PART - 1) / PART;
  localparam BITS = LEFT + RIGHT;

  // Each part's product at its place.
  logic [BITS*ROWS*COLUMNS-1:0] parts;
  genvar r, c;
  generate
    for (r = 0; r < ROWS; r = r + 1) begin : gen_row
      for (c = 0; c < COLUMNS; c = c + 1) begin : gen_column
        localparam A = LEFT - r * PART < PART ? LEFT - r * PART : PART;
        localparam B = RIGHT - c * PART < PART ? RIGHT - c * PART : PART;
        logic [A-1:0] a;
        logic [B-1:0] b;
        logic [A+B-1:0] part;
        assign a = left[r*PART+:A];
        assign b = right[c*PART+:B];
        if (B == 1) begin : gen_gates
          always_ff @(posedge clk) if (advance) part <= b ? {1'b0, a} : {(A + 1) {1'b0}};
        end else if (A == 1) begin : gen_gates_left
          always_ff @(posedge clk) if (advance) part <= a ? {1'b0, b} : {(B + 1) {1'b0}};
        end else begin : gen_multiplier
          always_ff @(posedge clk) if (advance) part <= a * b;
        end
        assign parts[(r*COLUMNS+c)*BITS+:BITS] = BITS'(part) << ((r + c) * PART);
      end
    end
    if (ROWS == 1 && COLUMNS == 1) begin : gen_alone
      always_ff @(posedge clk) if (advance) product <= parts + ADD;
    end else if (ROWS * COLUMNS == 2) begin : gen_two
      always_ff @(posedge clk) if (advance) product <= parts[0+:BITS] + parts[BITS+:BITS] + ADD;
    end else if (ROWS * COLUMNS == 3) begin : gen_three
      always_ff @(posedge clk) if (advance) product <= parts[0+:BITS] + parts[BITS+:BITS] + parts[2*BITS+:BITS] + ADD;
    end else if (ROWS * COLUMNS == 4) begin : gen_four
      // Parts that do not overlap stand in one word.
      if (COLUMNS == 2) begin : gen_square
        always_ff @(posedge clk) if (advance) product <= (parts[0+:BITS] | parts[3*BITS+:BITS]) + parts[BITS+:BITS] + parts[2*BITS+:BITS] + ADD;
      end else begin : gen_row
        always_ff @(posedge clk) if (advance) product <= (parts[0+:BITS] | parts[2*BITS+:BITS]) + (parts[BITS+:BITS] | parts[3*BITS+:BITS]) + ADD;
      end
    end else begin : gen_too_wide
      $error("multiply: factors of so many bits have too many parts");
    end
  endgenerate
endmodule
