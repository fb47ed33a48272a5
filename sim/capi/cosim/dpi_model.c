// DPI-C: the kernel as functions that a SystemVerilog bench imports. The state lives here because SystemVerilog has no
// pointers.
#include "tiles.h"
#include <svdpi.h>

static Bench bench;

// Packets of each tile, or an error below 0.
int model_begin(void) {
    int32_t status = bench_prepare(&bench, SPLATLINE_STANDARD24);
    return status < 0 ? status : bench.visible;
}

// The rules at the design's widths.
void model_rules(int *alpha_max, long long *least, int *minimum_transmittance, int *omit_finishing, int *wide_table) {
    *alpha_max = (int)bench.rules.alpha_max;
    *least = (long long)bench.rules.least;
    *minimum_transmittance = (int)bench.rules.minimum_transmittance;
    *omit_finishing = (int)bench.rules.omit_finishing;
    *wide_table = (int)bench.rules.wide_table;
}

// An entry of the footprint table and the step to the next.
void model_table(int index, int *low, int *step) {
    uint32_t entry, down;
    bench_table(&bench, (uint32_t)index, &entry, &down);
    *low = (int)entry;
    *step = (int)down;
}

// Words of a packet, and entries of the footprint table; 0 before the picture is set up.
void model_sizes(int *packet_words, int *table_entries) {
    size_t words = 0;
    splatline_packet_words(&bench.painter.widths, SPLATLINE_TRAVERSAL_SPANS, &words);
    *packet_words = (int)words;
    *table_entries = (int)bench.painter.table_count;
}

// A tile's window: 1, or 0 if there is no such tile.
int model_tile(int tile, int *first_column, int *first_row, int *end_column, int *end_row) {
    SplatlineWindow window = bench_tile(tile);
    *first_column = window.first[0];
    *first_row = window.first[1];
    *end_column = window.end[0];
    *end_row = window.end[1];
    return tile < TILE_COUNT;
}

// The i-th packet in drawing order.
int model_packet(int i, svBitVecVal *packet) { return bench_packet(&bench, i, packet); }

// Is that the pixel that the kernel has?
int model_pixel_is(int x, int y, int flag, int transmittance, int red, int green, int blue) {
    const uint32_t colour[3] = {(uint32_t)red, (uint32_t)green, (uint32_t)blue};
    return bench_pixel_is(&bench, x, y, (uint32_t)flag, (uint32_t)transmittance, colour);
}
