// left * right, two cycles later, unsigned: products of 18-bit parts in the first, their sum in the second.
//
// A multiplier of a board has some 18 bits; a wider product in one cycle would chain several of them and an adder. The
// lowest part of a product needs no adder, and of the others never more than three are added, two where a factor fits
// one multiplier. A part of up to ADDED_BITS bits, 4 at most, takes no multiplier but three additions, of which two
// stand in the first cycle: with 18 bits it is 62 look-up tables of an ECP5, where multipliers are what a machine runs
// out of. With 0 it takes one.
//
// The product's lowest 18 bits are there a cycle before it: a rounding that asks whether any of them is set need not
// stand before an addition.
//
// A fraction whose 1.0 is a value has a bit more than its multiplier. With RIGHT_UNIT, `right` is at most
// 1.0 = 2^(RIGHT-1): then its other bits are 0 where the first is set, and that bit's product stands beside the
// others', not in their sum. LEFT_UNIT says the same of `left`.
module multiply #(
    parameter LEFT = 18,
    parameter RIGHT = 18,
    parameter LEFT_UNIT = 0,
    parameter RIGHT_UNIT = 0,
    parameter ADDED_BITS = 4
) (
    input logic clk,
    input logic advance,
    input logic [LEFT-1:0] left,
    input logic [RIGHT-1:0] right,
    output logic [17:0] low,
    output logic [LEFT+RIGHT-1:0] product
);
  localparam PART = 18;
  // Bits of the factors that multipliers take.
  localparam TALL = LEFT_UNIT ? LEFT - 1 : LEFT;
  localparam LONG = RIGHT_UNIT ? RIGHT - 1 : RIGHT;
  localparam ROWS = (TALL + PART - 1) / PART;
  localparam COLUMNS = (LONG + PART - 1) / PART;
  localparam BITS = LEFT + RIGHT;

  // Each part's product at its place.
  logic [BITS*ROWS*COLUMNS-1:0] parts;
  genvar r, c;
  generate
    for (r = 0; r < ROWS; r = r + 1) begin : gen_row
      for (c = 0; c < COLUMNS; c = c + 1) begin : gen_column
        localparam A = TALL - r * PART < PART ? TALL - r * PART : PART;
        localparam B = LONG - c * PART < PART ? LONG - c * PART : PART;
        localparam WIDE = A < B ? B : A;
        localparam NARROW = A < B ? A : B;
        logic [A-1:0] a;
        logic [B-1:0] b;
        logic [A+B-1:0] part;
        assign a = left[r*PART+:A];
        assign b = right[c*PART+:B];
        if (B == 1) begin : gen_gates
          always_ff @(posedge clk) if (advance) part <= b ? {1'b0, a} : {(A + 1) {1'b0}};
        end else if (A == 1) begin : gen_gates_left
          always_ff @(posedge clk) if (advance) part <= a ? {1'b0, b} : {(B + 1) {1'b0}};
        end else if (NARROW <= ADDED_BITS) begin : gen_additions
          logic [WIDE-1:0] wide;
          logic [3:0] few;
          if (A < B) begin : gen_few_left
            assign {wide, few} = {b, 4'(a)};
          end else begin : gen_few_right
            assign {wide, few} = {a, 4'(b)};
          end
          // The products of two bits each.
          logic [WIDE+1:0] lower, upper;
          always_ff @(posedge clk)
            if (advance) begin
              lower <= {2'b00, {WIDE{few[0]}} & wide} + {1'b0, {WIDE{few[1]}} & wide, 1'b0};
              upper <= {2'b00, {WIDE{few[2]}} & wide} + {1'b0, {WIDE{few[3]}} & wide, 1'b0};
            end
          assign part = (A + B)'(lower) + (A + B)'({upper, 2'b00});
        end else begin : gen_multiplier
          always_ff @(posedge clk) if (advance) part <= a * b;
        end
        assign parts[(r*COLUMNS+c)*BITS+:BITS] = BITS'(part) << ((r + c) * PART);
      end
    end

    // What the bits of 1.0 give.
    logic [BITS-1:0] whole_left, whole_right, whole;
    if (LEFT_UNIT) begin : gen_left_unit
      assign whole_left = left[LEFT-1] ? BITS'(right[LONG-1:0]) << (LEFT - 1) : '0;
    end else begin : gen_no_left_unit
      assign whole_left = 0;
    end
    if (RIGHT_UNIT) begin : gen_right_unit
      assign whole_right = right[RIGHT-1] ? BITS'(left) << (RIGHT - 1) : '0;
    end else begin : gen_no_right_unit
      assign whole_right = 0;
    end
    always_ff @(posedge clk) if (advance) whole <= whole_left | whole_right;

    assign low = whole[PART-1:0] | parts[PART-1:0];
    if (ROWS == 1 && COLUMNS == 1) begin : gen_alone
      always_ff @(posedge clk) if (advance) product <= parts | whole;
    end else begin : gen_sum
      // The first part's lowest bits pass by the adder.
      logic [BITS-PART-1:0] high;
      if (ROWS * COLUMNS == 2) begin : gen_two
        assign high = parts[BITS-1:PART] + (parts[2*BITS-1:BITS+PART] | whole[BITS-1:PART]);
      end else if (ROWS * COLUMNS == 3) begin : gen_three
        assign high = (parts[BITS-1:PART] | parts[3*BITS-1:2*BITS+PART]) + (parts[2*BITS-1:BITS+PART] | whole[BITS-1:PART]);
      end else if (ROWS * COLUMNS == 4 && COLUMNS == 2) begin : gen_square
        // Parts that do not overlap stand in one word.
        assign high = (parts[BITS-1:PART] | parts[4*BITS-1:3*BITS+PART] | whole[BITS-1:PART]) + parts[2*BITS-1:BITS+PART] + parts[3*BITS-1:2*BITS+PART];
      end else if (ROWS * COLUMNS == 4) begin : gen_line
        assign high = (parts[BITS-1:PART] | parts[3*BITS-1:2*BITS+PART]) + (parts[2*BITS-1:BITS+PART] | parts[4*BITS-1:3*BITS+PART] | whole[BITS-1:PART]);
      end else begin : gen_too_wide
        $error("multiply: factors of so many bits have too many parts");
      end
      always_ff @(posedge clk) if (advance) product <= {high, low};
    end
  endgenerate
endmodule
