// The example picture in tiles: packets, table and rules for the circuit, and the kernel's words to compare with.
#include "tiles.h"
#include <string.h>

int32_t bench_prepare(Bench *bench, uint32_t design) {
    int32_t status = draw_picture(&bench->memory, design, SPLATLINE_TRAVERSAL_SPANS, WHOLE_FOOTPRINTS, bench->expected, COLUMNS);
    if (status >= 0) {
        status = prepare_picture(&bench->memory, design, SPLATLINE_TRAVERSAL_SPANS, &bench->painter, &bench->visible);
    }
    const SplatlineRules *rules = &bench->painter.rules;
    SplatlineBlendConstants constants;
    if (status >= 0) {
        status = splatline_blend_constants(&bench->painter.widths, rules, &constants);
    }
    if (status >= 0) {
        bench->rules.alpha_max = constants.alpha_max;
        bench->rules.least = constants.opacity_min;
        bench->rules.minimum_transmittance = constants.minimum_transmittance;
        bench->rules.omit_finishing = constants.omit_finishing;
        bench->rules.wide_table = rules->table_range == 4;
    }
    return status;
}

SplatlineWindow bench_tile(int tile) {
    uint16_t x = (uint16_t)(tile % TILES_ACROSS * TILE_COLUMNS);
    uint16_t y = (uint16_t)(tile / TILES_ACROSS * TILE_ROWS);
    uint16_t end = (uint16_t)(x + TILE_COLUMNS < COLUMNS ? x + TILE_COLUMNS : COLUMNS);
    SplatlineWindow window = {{x, y}, {end, (uint16_t)(y + TILE_ROWS)}};
    return window;
}

int32_t bench_packet(const Bench *bench, int i, uint32_t words[SPLATLINE_LONGEST_PACKET]) {
    size_t count;
    int32_t status = splatline_packet_words(&bench->painter.widths, SPLATLINE_TRAVERSAL_SPANS, &count);
    memset(words, 0, SPLATLINE_LONGEST_PACKET * sizeof *words);
    if (status < 0) {
        return status;
    }
    const SplatlineFootprint *footprint = &bench->memory.footprints[bench->memory.order[i]];
    return splatline_packet_encode(&bench->painter.widths, SPLATLINE_TRAVERSAL_SPANS, footprint, words, count);
}

void bench_table(const Bench *bench, uint32_t index, uint32_t *low, uint32_t *step) {
    const SplatlinePainter *painter = &bench->painter;
    uint32_t next = index + 1 < painter->table_count ? painter->table[index + 1] : 0; // beyond its end the kernel is 0
    *low = painter->table[index];
    *step = *low - next;
}

int bench_pixel_is(const Bench *bench, int x, int y, uint32_t flag, uint32_t transmittance, const uint32_t colour[3]) {
    const SplatlinePixel *pixel = &bench->expected[y * COLUMNS + x];
    return pixel->transmittance == (flag << 31 | transmittance) && memcmp(pixel->colour, colour, sizeof pixel->colour) == 0;
}
