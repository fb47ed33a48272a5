// SystemVerilog bench: the splat primitive (design standard24) against the kernel by DPI-C, every word of the example
// picture's tiles. Your own rasterizer takes the primitive's place.
module dpi_bench;
    import "DPI-C" function int model_begin();
    import "DPI-C" function void model_rules(output int alpha_max, output longint least, output int minimum_transmittance, output int omit_finishing, output int wide_table);
    import "DPI-C" function void model_table(input int index, output int low, output int step);
    import "DPI-C" function int model_tile(input int tile, output int first_column, output int first_row, output int end_column, output int end_row);
    import "DPI-C" function int model_packet(input int i, output bit [671:0] packet);
    import "DPI-C" function int model_pixel_is(input int x, input int y, input int flag, input int transmittance, input int red, input int green, input int blue);

    localparam T = splatline_pkg::TRANSMITTANCE;
    localparam SUM = splatline_pkg::SUM_BITS;

    logic clk = 0;
    logic rst = 1;
    logic table_valid = 0, tile_valid = 0, packet_valid = 0, finish_valid = 0, pixel_ready = 0;
    logic tile_ready, packet_ready, finish_ready, pixel_valid;
    logic [T+1:0] transmittance;
    logic [3*SUM-1:0] colour;
    longint least;
    int alpha_max, minimum_transmittance, omit_finishing, wide_table, index, low, step;
    int first_column, first_row, end_column, end_row, packets;
    int pixels = 0;
    bit [671:0] words;
    splatline_pkg::rules_t rules;
    splatline_pkg::window_t tile;

    assign rules = {alpha_max[splatline_pkg::ALPHA:0], least[splatline_pkg::PEAK+splatline_pkg::WEIGHT:0], minimum_transmittance[T:0], omit_finishing[0], wide_table[0]};
    assign tile = {first_column[15:0], first_row[15:0], end_column[15:0], end_row[15:0]};

    splat_primitive #(.LANES(4)) splats (
        .clk, .rst, .rules, .tile,
        .table_valid, .table_index(index[splatline_pkg::TABLE:0]),
        .table_low(low[splatline_pkg::WEIGHT:0]), .table_step(step[splatline_pkg::STEP_BITS-1:0]),
        .tile_valid, .tile_ready,
        .packet_valid, .packet_ready, .packet(words[splatline_pkg::PACKET_BITS-1:0]),
        .finish_valid, .finish_ready,
        .pixel_valid, .pixel_ready, .pixel_transmittance(transmittance), .pixel_colour(colour),
        .lanes_enable(1'b1), .raster_idle(), .idle(), .foreign_packets()
    );

    task automatic clock();
        #1 clk = 1;
        #1 clk = 0;
    endtask

    // Reads the tile out, row by row, and compares.
    task automatic compare();
        for (int y = first_row; y < end_row; y++)
            for (int x = first_column; x < end_column; x++) begin
                while (!pixel_valid) clock();
                if (model_pixel_is(x, y, 32'(transmittance[T+1]), 32'(transmittance[T:0]), 32'(colour[0+:SUM]), 32'(colour[SUM+:SUM]), 32'(colour[2*SUM+:SUM])) == 0)
                    $fatal(1, "pixel (%0d, %0d): the circuit has %h, transmittance %h", x, y, colour, transmittance);
                pixels = pixels + 1;
                pixel_ready = 1;
                clock();
                pixel_ready = 0;
            end
    endtask

    initial begin
        packets = model_begin();
        if (packets <= 0) $fatal(1, "the model does not start");
        model_rules(alpha_max, least, minimum_transmittance, omit_finishing, wide_table);
        repeat (4) clock();
        rst = 0;
        table_valid = 1;
        for (index = 0; index <= 1 << splatline_pkg::TABLE; index++) begin
            model_table(index, low, step);
            clock();
        end
        table_valid = 0;
        for (int number = 0; model_tile(number, first_column, first_row, end_column, end_row) > 0; number++) begin
            if (end_column - first_column > 1 << splatline_pkg::TILE_COLUMN_BITS || end_row - first_row > 1 << splatline_pkg::TILE_ROW_BITS)
                $fatal(1, "tile %0d is larger than the circuit's buffer", number);
            tile_valid = 1;
            #1 while (!tile_ready) clock();
            clock();
            tile_valid = 0;
            packet_valid = 1;
            for (int i = 0; i < packets; i++) begin
                if (model_packet(i, words) < 0) $fatal(1, "no packet %0d", i);
                #1 while (!packet_ready) clock();
                clock();
            end
            packet_valid = 0;
            finish_valid = 1;
            #1 while (!finish_ready) clock();
            clock();
            finish_valid = 0;
            compare();
        end
        $display("DPI-C bench: %0d pixels, 0 mismatches", pixels);
        $finish;
    end
endmodule
