// What both benches of the co-simulation guide share: the example picture in tiles, as the splat primitive takes it.
#ifndef TILES_H
#define TILES_H

#include "picture.h"

#ifdef __cplusplus
extern "C" {
#endif

// Tiles as large as the circuit's buffer (TILE_COLUMN_BITS and TILE_ROW_BITS of its package).
enum { TILE_COLUMNS = 32, TILE_ROWS = 32, TILES_ACROSS = (COLUMNS + TILE_COLUMNS - 1) / TILE_COLUMNS, TILE_COUNT = TILES_ACROSS * (ROWS / TILE_ROWS) };

// The rules of blending at the design's widths: the circuit's `rules_t`.
typedef struct {
    uint64_t least;     // UQ4.(peak + weight): smaller products are skipped
    uint32_t alpha_max; // UQ1.alpha
    uint32_t minimum_transmittance;      // UQ1.transmittance
    uint32_t omit_finishing, wide_table;
} CircuitRules;

// Everything that is fed to the circuit, and the picture that must come out.
typedef struct {
    Memory memory;
    SplatlinePainter painter;
    int visible; // packets of each tile
    CircuitRules rules;
    SplatlinePixel expected[COLUMNS * ROWS];
} Bench;

// Sets the example picture up and draws it by the kernel. Returns an error below 0.
int32_t bench_prepare(Bench *bench, uint32_t design);

// The window of a tile, row by row over the picture; the last of a row is narrower.
SplatlineWindow bench_tile(int tile);

// The packet of the i-th footprint in drawing order; unused words are 0. Returns an error below 0.
int32_t bench_packet(const Bench *bench, int i, uint32_t words[SPLATLINE_LONGEST_PACKET]);

// An entry of the footprint table as the circuit stores it: the kernel, and the step down to the next entry.
void bench_table(const Bench *bench, uint32_t index, uint32_t *low, uint32_t *step);

// Is that what the kernel has in this pixel? `flag` is the circuit's bit for a pixel that takes no more splats.
int bench_pixel_is(const Bench *bench, int x, int y, uint32_t flag, uint32_t transmittance, const uint32_t colour[3]);

#ifdef __cplusplus
}
#endif

#endif
