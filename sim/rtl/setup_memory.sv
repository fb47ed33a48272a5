// Registers and tables of two cores, or of one: all cores obey the same slot, so that their registers have the same
// addresses in the same cycle and stand side by side. A word of 51 bits alone would leave a third of its two block RAMs
// unused. The tables are a memory with a port for each of the two.
module setup_memory #(
    parameter CORES = 2
) (
    input logic clk,
    input logic write,
    input logic [7:0] write_place,
    input logic [51*CORES-1:0] results,
    // Both factors; what a slot does not read is 0.
    input logic unread_a,
    input logic unread_b,
    input logic [7:0] a_place,
    input logic [7:0] b_place,
    output logic [51*CORES-1:0] a,
    output logic [51*CORES-1:0] b,
    // An argument's entry of a table, or the step to the next one.
    input logic entry,
    input logic [9*CORES-1:0] index,
    output logic [32*CORES-1:0] found  // two cycles later
);
  (* ram_style = "block", no_rw_check *) logic [51*CORES-1:0] registers_a[0:255];
  (* ram_style = "block", no_rw_check *) logic [51*CORES-1:0] registers_b[0:255];
  always_ff @(posedge clk) begin
    if (write) begin
      registers_a[write_place] <= results;
      registers_b[write_place] <= results;
    end
    a <= unread_a ? '0 : registers_a[a_place];
    b <= unread_b ? '0 : registers_b[b_place];
  end

  (* ram_style = "block" *) logic [31:0] entries[0:1023];
  initial for (int i = 0; i < 1024; i = i + 1) entries[i] = splatline_tables::setup_entry(10'(i));
  genvar i;
  generate
    for (i = 0; i < CORES; i = i + 1) begin : gen_port
      logic [31:0] read;
      always_ff @(posedge clk) begin
        read <= entries[{entry, index[9*i+:9]}];
        found[32*i+:32] <= read;
      end
    end
  endgenerate
endmodule
