// A small scene drawn through the C ABI; the same code runs on a PC and on a microcontroller.
#ifndef PICTURE_H
#define PICTURE_H

#include "splatline.h"

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

// Draws into ROWS rows of COLUMNS pixels, `stride` pixels apart. Returns 0, or the first error of the library.
int32_t draw_picture(Memory *memory, uint32_t design, uint32_t traversal, enum Way way, SplatlinePixel *pixels, size_t stride);

#endif
