// SystemVerilog bench without any foreign code: the lane against exported vectors, in any simulator that reads
// $readmemh. The fields of runs.hex are those of manifest.json for lanes of 32 bits; `count` is its number of records.
//
// The bench writes what the lane computed as its own tile of results: one radial index per pixel and line, for `diff`.
module vectors_bench;
    parameter int COUNT = 1;
    parameter int RECORD = 176;
    logic [RECORD-1:0] runs [0:COUNT-1];
    logic clock = 0;
    logic load = 0;
    logic step = 0;
    logic [31:0] radial;
    logic [RECORD-1:0] run;
    int file;
    int length;

    run_lane #(.WIDTH(32)) lane (
        .clock(clock), .load(load), .step(step),
        .seed_radial(run[111:80]), .seed_first(run[143:112]), .seed_second(run[175:144]),
        .radial(radial)
    );

    initial begin
        $readmemh("runs.hex", runs);
        file = $fopen("radials.hex", "w");
        for (int i = 0; i < COUNT; i++) begin
            run = runs[i];
            length = int'(run[79:64]);
            load = 1;
            step = 0;
            #1 clock = 1;
            #1 clock = 0;
            load = 0;
            step = 1;
            for (int k = 0; k < length; k++) begin
                $fdisplay(file, "%08x", radial);
                #1 clock = 1;
                #1 clock = 0;
            end
        end
        $fclose(file);
        $finish;
    end
endmodule
