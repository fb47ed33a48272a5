// The design under test of the co-simulation guide: one pixel lane, second-order forward differencing along a run
// ([EWA] 7.1.2). Replace it by your own rasterizer: the benches only need a run in and one radial index per pixel out.
//
// `load` takes a run's seed; in every cycle with `step` the lane moves on to the next pixel.
module run_lane #(
    parameter int WIDTH = 32
) (
    input  logic             clock,
    input  logic             load,
    input  logic             step,
    input  logic [WIDTH-1:0] seed_radial,
    input  logic [WIDTH-1:0] seed_first,
    input  logic [WIDTH-1:0] seed_second,
    output logic [WIDTH-1:0] radial
);
    logic [WIDTH-1:0] first;
    logic [WIDTH-1:0] second;

    always_ff @(posedge clock) begin
        if (load) begin
            radial <= seed_radial;
            first <= seed_first;
            second <= seed_second;
        end else if (step) begin
            radial <= radial + first;
            first <= first + second;
        end
    end
endmodule
