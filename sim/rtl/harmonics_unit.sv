// Colour of a splat in its direction: real spherical harmonics of degree 0 to 4, as `Harmonics::colour` of
// src/setup/harmonics.rs, bit for bit, for every direction, colour and coefficient.
//
//   direction, degree -> basis: harmonics Y_1 .. Y_24 (Q2.28) -> memory of two banks
//     -> sum: base + Y_1 c_1 + ... -> to odd, clamped -> colour
//               ^- base, c_1, c_2, ...
//
// All in it is sums of products, as in the setup unit. The basis is a program of such terms (harmonics_program,
// generated), one in a cycle: products of registers, rounded to Q.30 and wrapped at 64 bits as the kernel's; small
// multiples; constants, whose results are the harmonics. The sum takes one channel of one word in a cycle. The base is
// the coefficient of a harmonic that is 1. While the sum takes one splat's words the basis works on the next splat.
//
// MULTIPLIERS = 1: both use one multiplier (four of 18 bits); the basis goes first, and the sum takes the cycles in
// which it waits for results, for a splat or for a bank. MULTIPLIERS = 2: one each, which
// are busy for as many cycles: 75 terms each for degree 4. More would wait for the basis. Units side by side share
// nothing but need nothing of each other.
//
// Formats: direction 3 x Q1.30, clamped to +-1; base and coefficients 3 x Q3.28, the base first and then 3, 8, 15 or 24
// words in the kernel's order; colour 3 x UQ4.28; the first channel in the lowest bits. A degree above 4 is 4. The
// splat is taken when its direction has been read, before its words.
//
// A direction's polynomials stay within 4 or are clamped to it. For no direction does any harmonic leave Q2.28 (the
// kernel's last clamp of them changes nothing): constants of 2 and above belong to polynomials within 1, and 4 times
// any other is less than 8. 24 products of 2^46 and a base of 2^43 stay within 52 bits.
module harmonics_unit #(
    parameter MULTIPLIERS = 1
) (
    input logic clk,
    input logic rst,
    input logic splat_valid,
    output logic splat_ready,
    input logic [95:0] direction,
    input logic [2:0] degree,
    input logic word_valid,
    output logic word_ready,
    input logic [95:0] word,
    output logic colour_valid,
    input logic colour_ready,
    output logic [95:0] colour
);
  generate
    if (MULTIPLIERS != 1 && MULTIPLIERS != 2) begin : gen_illegal
      $error("harmonics_unit: MULTIPLIERS must be 1 or 2");
    end
  endgenerate

  // 0, the basis: which place of the program it is at, and which bank its harmonics go to. Places 0 to 2 load the
  // direction; those of a gap wait for results and do not need the multiplier.
  localparam [6:0] LOADS = 7'd3;
  logic [6:0] place, end_place;
  logic [2:0] splat_degree;
  logic bank, loading, gap, ends, basis_moves, basis_issues;
  logic [1:0] full;
  assign loading = place < LOADS;
  assign ends = place == end_place;
  assign basis_moves = !loading || (splat_valid && !full[bank]);
  assign basis_issues = basis_moves && !gap;
  assign splat_ready = place == LOADS - 7'd1 && !full[bank];

  // 0, the sum: which channel of which word, and the bank of its harmonics. A colour's last word waits until the colour
  // before has been taken.
  logic [4:0] index, count, count0, count1;
  logic [1:0] channel;
  logic read_bank, last_word, pending, colour_may, colour_issues;
  assign count = read_bank ? count1 : count0;
  assign last_word = index == count;
  assign colour_may = full[read_bank] && !(last_word && channel == 0 && pending) && !(MULTIPLIERS == 1 && basis_issues);
  assign colour_issues = colour_may && word_valid;
  assign word_ready = colour_may && channel == 2'd2;

  function automatic logic [4:0] coefficients(input logic [2:0] of_degree);
    case (of_degree)
      3'd0: coefficients = 5'd0;
      3'd1: coefficients = 5'd3;
      3'd2: coefficients = 5'd8;
      3'd3: coefficients = 5'd15;
      default: coefficients = 5'd24;
    endcase
  endfunction

  always_ff @(posedge clk) begin
    if (basis_moves) begin
      place <= ends ? 7'd0 : place + 7'd1;
      if (place == 0) splat_degree <= degree;
      if (ends) begin
        bank <= !bank;
        full[bank] <= 1;
        if (bank) count1 <= coefficients(splat_degree);
        else count0 <= coefficients(splat_degree);
      end
    end
    if (colour_valid && colour_ready) pending <= 0;
    if (colour_issues) begin
      channel <= channel == 2'd2 ? 2'd0 : channel + 2'd1;
      if (last_word && channel == 0) pending <= 1;
      if (channel == 2'd2) index <= last_word ? 5'd0 : index + 5'd1;
      if (channel == 2'd2 && last_word) begin
        read_bank <= !read_bank;
        full[read_bank] <= 0;
      end
    end
    if (rst) begin
      {place, bank, index, channel, read_bank, pending} <= 0;
      full <= 0;
    end
  end

  // 1 and 2: the slot, and what comes from outside: an axis of the direction, a channel of the word.
  logic [55:0] program1, slot2;
  logic [31:0] axis0, channel0;
  logic [5:0] weight1, weight2;
  // What is in the pipeline, by stage.
  logic [9:1] basis, bases, lasts, dones, banks;
  logic [10:1] sums;
  logic [4:1] loads;
  assign axis0 = place[1] ? direction[95:64] : place[0] ? direction[63:32] : direction[31:0];
  assign channel0 = channel[1] ? word[95:64] : channel[0] ? word[63:32] : word[31:0];
  harmonics_program rom (.clk, .place, .degree(splat_degree), .slot(program1), .end_place, .gap);
  always_ff @(posedge clk) begin
    slot2 <= program1;
    weight1 <= {read_bank, index};
    weight2 <= weight1;
    basis <= {basis[8:1], basis_issues};
    sums <= {sums[9:1], colour_issues};
    loads <= {loads[3:1], basis_moves && loading};
    bases <= {bases[8:1], index == 0};
    lasts <= {lasts[8:1], last_word};
    dones <= {dones[8:1], last_word && channel == 2'd2};
    banks <= {banks[8:1], bank};
    if (rst) {basis, sums} <= 0;
  end

  // 2 and 3: registers and harmonics are read. What does not belong to the slot is 0, so that factors are the or of all
  // that they may be.
  (* ram_style = "block", no_rw_check *) logic [35:0] registers_a[0:63];
  (* ram_style = "block", no_rw_check *) logic [33:0] registers_b[0:63];
  (* ram_style = "block", no_rw_check *) logic [31:0] harmonics[0:63];
  logic [35:0] a3;
  logic [33:0] b3;
  logic [31:0] y3;
  logic [30:0] constant3;
  logic product3, register3, clamped3, clamped4, negated3, negated4, negated5, wide3, wide4, wide5;
  logic [5:0] target10;
  logic [35:0] result10;
  logic register10, harmonic10, bank10;
  always_ff @(posedge clk) begin
    if (register10) begin
      registers_a[target10] <= result10;
      registers_b[target10] <= result10[33:0];
    end
    if (harmonic10) harmonics[{bank10, target10[4:0]}] <= result10[31:0];
    a3 <= registers_a[slot2[5:0]];
    b3 <= registers_b[slot2[11:6]];
    y3 <= harmonics[weight2];
    constant3 <= basis[2] ? slot2[48:18] : 31'd0;
    register3 <= basis[2] && !loads[2];
    product3 <= basis[2] && slot2[49];
    clamped3 <= basis[2] && slot2[50];
    wide3 <= !basis[2] || slot2[51];
    negated3 <= basis[2] && slot2[52];
    {clamped4, negated4, negated5, wide4, wide5} <= {clamped3, negated3, negated4, wide3, wide4};
  end

  // 3 and 4: factors. A direction is loaded as a product with 2^16 and a quotient by it, the base as the coefficient of
  // a harmonic of 1.
  logic signed [35:0] basis_left3, left4, left5;
  logic signed [34:0] basis_right3, right4, right5;
  logic signed [31:0] outside3;
  logic signed [32:0] sum_left3;
  assign basis_left3 = (a3 & {36{register3}}) | {19'd0, loads[3], 16'd0};
  assign basis_right3 = ({b3, 1'b0} & {35{product3}}) | {4'd0, constant3};
  assign sum_left3 = ({y3[31], y3} & {33{sums[3] && !bases[3]}}) | {4'd0, sums[3] && bases[3], 28'd0};

  // 4 and 5: polynomials between -4 and 4, directions between -1 and 1.
  logic outside4, beyond4;
  assign outside4 = clamped4 && left4[35:32] != {4{left4[35]}};
  assign beyond4 = loads[4] && right4[31] != right4[30];
  always_ff @(posedge clk) begin
    left5 <= outside4 ? {{4{left4[35]}}, {32{!left4[35]}}} : left4;
    right5 <= beyond4 ? {right4[34:31], 1'b1, 30'd0} : right4;
  end

  // 9 and 10: sums. Those of the basis follow each other without a pause; a channel's stands three terms back.
  logic signed [51:0] sum9, before9, colour9;
  logic signed [35:0] sum10;
  logic signed [51:0] colour10, colour11, colour12;
  logic [9:3] firsts;
  logic again9, more9;
  assign again9 = basis[9] && !firsts[9];
  assign more9 = sums[9] && !bases[9];
  always_ff @(posedge clk) begin
    firsts <= {firsts[8:3], slot2[53]};
    sum10 <= sum9[35:0];
    if (sums[9]) {colour12, colour11, colour10} <= {colour11, colour10, colour9};
  end
  harmonics_term #(.LEFT(36), .RIGHT(35)) term (.clk, .left5, .right5, .negated5, .wide5, .before9, .sum9);

  generate
    if (MULTIPLIERS == 1) begin : gen_one
      logic [31:0] outside1, outside2;
      always_ff @(posedge clk) begin
        outside1 <= colour_issues ? channel0 : axis0;
        outside2 <= outside1;
        outside3 <= sums[2] || loads[2] ? outside2 : 32'd0;
        left4 <= basis_left3 | {{3{sum_left3[32]}}, sum_left3};
        right4 <= basis_right3 | {{3{outside3[31]}}, outside3};
      end
      assign before9 = ({{16{sum10[35]}}, sum10} & {52{again9}}) | (colour12 & {52{more9}});
      assign colour9 = sum9;
    end else begin : gen_two
      logic signed [31:0] axis1, axis2, axis3, outside1, outside2, factor4, factor5;
      logic signed [32:0] weight4, weight5;
      always_ff @(posedge clk) begin
        {axis1, axis2} <= {axis0, axis1};
        axis3 <= loads[2] ? axis2 : 32'd0;
        left4 <= basis_left3;
        right4 <= basis_right3 | {{3{axis3[31]}}, axis3};
        {outside1, outside2, outside3} <= {channel0, outside1, outside2};
        {weight4, weight5} <= {sum_left3, weight4};
        {factor4, factor5} <= {outside3, factor4};
      end
      assign before9 = {{16{sum10[35]}}, sum10} & {52{again9}};
      harmonics_term #(.LEFT(33), .RIGHT(33)) colour_term (
          .clk,
          .left5(weight5),
          .right5({factor5[31], factor5}),
          .negated5(1'b0),
          .wide5(1'b1),
          .before9(colour12 & {52{more9}}),
          .sum9(colour9)
      );
    end
  endgenerate

  // 10: results of the basis. A product of two registers wraps at 64 bits, which leaves 34 of its quotient.
  logic [9*8-1:0] fields;  // of stages 3 to 10: target, register, harmonic, wide
  logic wide10;
  always_ff @(posedge clk) begin
    fields <= {fields[9*7-1:0], slot2[17:12], slot2[54] && basis[2], slot2[55] && basis[2], slot2[51]};
    bank10 <= banks[9];
  end
  assign {target10, register10, harmonic10, wide10} = fields[9*8-1:9*7];
  assign result10 = {wide10 ? sum10[35:34] : {2{sum10[33]}}, sum10[33:0]};

  // 10: the colour, to odd: what is cut off leaves a one.
  logic last10, done10, lost10, high10;
  logic [31:0] channel10;
  assign lost10 = colour10[11:0] != 0;
  assign high10 = colour10[50:44] != 0;
  assign channel10 = colour10[51] ? 32'd0 : high10 ? 32'hffff_ffff : {colour10[43:13], colour10[12] | lost10};
  always_ff @(posedge clk) begin
    {last10, done10} <= {lasts[9], dones[9]};
    if (sums[10] && last10) colour <= {channel10, colour[95:32]};
    if (colour_ready) colour_valid <= 0;
    if (sums[10] && done10) colour_valid <= 1;
    if (rst) colour_valid <= 0;
  end
endmodule
