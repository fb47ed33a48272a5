// Who reads next, and whose word comes: units in fixed order at one port, whose words come in the order in which they
// were asked for.
//
// A unit asks only for what it has a place for, so that words are never held; together they may ask for 2^DEPTH words
// at most. Units lie all over the chip: a register slice in front of the choice parts their ways from each other's, and
// words have two registers on their way back, the first while a block RAM says whose they are.
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
    output logic [127:0] coming,
    output logic read_valid,
    input logic read_ready,
    output logic [31:0] read_address,
    input logic word_valid,
    input logic [127:0] word
);
  // No word comes in the cycle in which it is asked for.
  (* ram_style = "block", no_rw_check *) logic [UNITS-1:0] requesters[0:(1<<DEPTH)-1];
  logic [DEPTH-1:0] issued, returned;
  logic [UNITS-1:0] requester;
  logic returns;
  logic [127:0] returning;
  logic [UNITS-1:0] waiting, chosen;
  logic [32*UNITS-1:0] waiting_address;

  genvar u;
  generate
    for (u = 0; u < UNITS; u = u + 1) begin : gen_unit
      register_slice #(
          .BITS(32)
      ) slice (
          .clk,
          .rst,
          .in_valid(valid[u]),
          .in_ready(ready[u]),
          .ready_next(),
          .in(address[32*u+:32]),
          .out_valid(waiting[u]),
          .out_ready(read_ready && chosen[u]),
          .out(waiting_address[32*u+:32])
      );
    end
  endgenerate

  always_comb begin
    chosen = 0;
    read_address = 0;
    for (int i = UNITS - 1; i >= 0; i = i - 1) begin
      if (waiting[i]) begin
        chosen = UNITS'(1) << i;
        read_address = waiting_address[32*i+:32];
      end
    end
  end
  assign read_valid = chosen != 0;

  always_ff @(posedge clk) begin
    if (read_valid && read_ready) begin
      requesters[issued] <= chosen;
      issued <= issued + 1'b1;
    end
    requester <= requesters[returned];
    {returns, returning} <= {word_valid, word};
    {comes, coming} <= {returns ? requester : '0, returning};
    if (word_valid) returned <= returned + 1'b1;
    if (rst) {issued, returned, returns, comes} <= 0;
  end
endmodule
