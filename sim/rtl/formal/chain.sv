// Liveness of a small chain of the primitive's units, for `rtl -- formal`: queue of rows, queue of a lane, lane.
// Whatever runs come and whenever they come, a run is begun within a bounded number of cycles while there is one, and
// the lane comes to rest.
module chain (
    input logic clk,
    input logic rst,
    input logic claim,
    input splatline_pkg::run_t in
);
  // The longest run, and the bound on the cycles without a run that begins: the pipeline before the queue, its
  // registers, those of the lane's queue, the run before and the distance from it.
  localparam PIXELS = 2;
  localparam BOUND = 16;

  logic [2:0] coming;
  logic free, none, valid, ready, queued, taken, empty, pixel_valid, lane_idle;
  splatline_pkg::run_t out, front;
  logic [splatline_pkg::RADIAL+3:0] radial;
  logic [splatline_pkg::TILE_ROW_BITS+splatline_pkg::TILE_COLUMN_BITS-1:0] address;
  logic [3:0] in_slot, queued_slot, slot;
  fifo #(.BITS($bits(in)), .PLACES(4)) rows (.clk, .rst, .claim, .free, .none, .in_valid(coming[2]), .in, .out_valid(valid), .out_ready(ready), .out);
  run_queue #(.DEPTH(2)) queue (.clk, .rst, .in_valid(valid), .in_ready(ready), .in_run(out), .in_slot, .out_valid(queued), .out_ready(taken), .out_run(front), .out_slot(queued_slot), .empty);
  lane pixels (.clk, .rst, .advance(1'b1), .run_valid(queued), .run_ready(taken), .run(front), .run_slot(queued_slot), .pixel_valid, .radial, .address, .slot, .idle(lane_idle));

  logic started;
  logic [5:0] waits;
  initial started = 0;
  always_ff @(posedge clk) begin
    started <= 1;
    if (rst) begin
      coming <= 0;
      waits <= 0;
    end else begin
      coming <= {coming[1:0], claim};
      if ((queued && taken) || (none && empty && lane_idle)) waits <= 0;
      else waits <= waits + 6'd1;
    end
  end
  always_comb begin
    assume (rst == !started);
    if (started) assume (!claim || free);
    assume (in.count != 0 && in.count <= PIXELS && {1'b0, in.column} + in.count <= (1 << splatline_pkg::TILE_COLUMN_BITS));
  end
  always_comb if (started) assert (waits < BOUND);
endmodule
