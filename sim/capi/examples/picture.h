// A small scene drawn through the C ABI; the same code runs on a PC, on a microcontroller and in a Verilator bench.
#ifndef PICTURE_H
#define PICTURE_H

#include "splatline.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { COLUMNS = 96, ROWS = 64, SPLATS = 200, LARGEST_TABLE = (1 << 12) + 1 };

// How the pixels are reached; all ways must give the same picture.
enum Way { WHOLE_FOOTPRINTS, TILES, STEP_BY_STEP };

// Memory for one picture: some 60 kB without the pixels. Nothing is allocated.
typedef struct {
    SplatlineSplat splats[SPLATS];
    SplatlineFootprint footprints[SPLATS];
    int32_t reasons[SPLATS];
    uint16_t order[SPLATS];
    uint32_t table[LARGEST_TABLE];
} Memory;

// The painter, and in `memory` the footprints with the order in which the `visible` ones are drawn. Returns an error
// below 0.
int32_t prepare_picture(Memory *memory, uint32_t design, uint32_t traversal, SplatlinePainter *painter, int *visible);

// Draws into ROWS rows of COLUMNS pixels, `stride` pixels apart. Returns 0, or the first error of the library.
int32_t draw_picture(Memory *memory, uint32_t design, uint32_t traversal, enum Way way, SplatlinePixel *pixels, size_t stride);

#ifdef __cplusplus
}
#endif

#endif
