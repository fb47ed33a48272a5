// Who reads next, and whose word comes: units in fixed order at one port, whose words come in the order in which they
// were asked for.
//
// A unit asks only for what it has a place for, so that words are never held; together they may ask for 2^DEPTH words
// at most.
module read_arbiter #(
    parameter UNITS = 3,
    parameter DEPTH = 9
) (
    input logic clk,
    input logic rst,
    input logic [UNITS-1:0] valid,  // the first has precedence
    output logic [UNITS-1:0] ready,
    input logic [32*UNITS-1:0] address,
    output logic [UNITS-1:0] comes,
    output logic read_valid,
    input logic read_ready,
    output logic [31:0] read_address,
    input logic word_valid
);
  (* ram_style = "distributed" *) logic [UNITS-1:0] requesters[0:(1<<DEPTH)-1];
  logic [DEPTH-1:0] issued, returned;
  logic [UNITS-1:0] chosen;

  always_comb begin
    chosen = 0;
    read_address = 0;
    for (int i = UNITS - 1; i >= 0; i = i - 1) begin
      if (valid[i]) begin
        chosen = UNITS'(1) << i;
        read_address = address[32*i+:32];
      end
    end
  end
  assign read_valid = chosen != 0;
  assign ready = read_ready ? chosen : '0;
  assign comes = word_valid ? requesters[returned] : '0;

  always_ff @(posedge clk) begin
    if (read_valid && read_ready) begin
      requesters[issued] <= chosen;
      issued <= issued + 1'b1;
    end
    if (word_valid) returned <= returned + 1'b1;
    if (rst) {issued, returned} <= 0;
  end
endmodule
