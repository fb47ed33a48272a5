// PC: draws with every design, both traversals and all three ways, and writes the pixels to the file named on the
// command line.
#include "picture.h"
#include <stdio.h>
#include <string.h>

enum { STRIDE = COLUMNS + 5 }; // wider than the window, to see that nothing is written between the rows

static Memory memory;
static SplatlinePixel pixels[3][ROWS * STRIDE];

int main(int arguments, char **argument) {
    if (arguments != 2) {
        fprintf(stderr, "usage: picture FILE\n");
        return 2;
    }
    if (splatline_abi_version() != SPLATLINE_ABI_VERSION) {
        fprintf(stderr, "header version %d, library version %u\n", SPLATLINE_ABI_VERSION, (unsigned)splatline_abi_version());
        return 1;
    }
    FILE *file = fopen(argument[1], "wb");
    if (!file) {
        perror(argument[1]);
        return 1;
    }
    for (uint32_t design = SPLATLINE_CLASSIC8; design <= SPLATLINE_DEEP32; design++) {
        for (uint32_t traversal = SPLATLINE_TRAVERSAL_BOX; traversal <= SPLATLINE_TRAVERSAL_SPANS; traversal++) {
            for (int way = WHOLE_FOOTPRINTS; way <= STEP_BY_STEP; way++) {
                int32_t status = draw_picture(&memory, design, traversal, (enum Way)way, pixels[way], STRIDE);
                if (status < 0) {
                    fprintf(stderr, "design %u, way %d: %s\n", (unsigned)design, way, splatline_error_text(status));
                    return 1;
                }
            }
            if (memcmp(pixels[0], pixels[1], sizeof pixels[0]) || memcmp(pixels[0], pixels[2], sizeof pixels[0])) {
                fprintf(stderr, "design %u, traversal %u: the ways differ\n", (unsigned)design, (unsigned)traversal);
                return 1;
            }
            for (int y = 0; y < ROWS; y++) {
                fwrite(&pixels[0][y * STRIDE], sizeof(SplatlinePixel), COLUMNS, file);
            }
        }
    }
    return fclose(file) ? 1 : 0;
}
