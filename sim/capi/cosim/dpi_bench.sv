// SystemVerilog bench: the lane against the kernel by DPI-C.
module dpi_bench;
    import "DPI-C" function int model_begin();
    import "DPI-C" function int model_next_run(output int radial, output int first, output int second, output int length);
    import "DPI-C" function int model_pixel();

    logic clock = 0;
    logic load = 0;
    logic step = 0;
    int radial_seed, first_seed, second_seed, length;
    logic [31:0] radial;
    int pixels = 0;
    int expected;

    run_lane #(.WIDTH(32)) lane (
        .clock(clock), .load(load), .step(step),
        .seed_radial(radial_seed), .seed_first(first_seed), .seed_second(second_seed),
        .radial(radial)
    );

    initial begin
        if (model_begin() < 0) $fatal(1, "the model does not start");
        while (model_next_run(radial_seed, first_seed, second_seed, length) > 0) begin
            load = 1;
            step = 0;
            #1 clock = 1;
            #1 clock = 0;
            load = 0;
            step = 1;
            for (int i = 0; i < length; i++) begin
                expected = model_pixel();
                if (radial != expected) $fatal(1, "pixel %0d: expected %08x, got %08x", pixels, expected, radial);
                pixels = pixels + 1;
                #1 clock = 1;
                #1 clock = 0;
            end
        end
        $display("DPI-C bench: %0d pixels, 0 mismatches", pixels);
        $finish;
    end
endmodule
