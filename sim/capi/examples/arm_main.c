// Arm: vector table and a main that draws one picture; 0 in `result` means that it came out.
#include "picture.h"

extern uint32_t stack_top[];

static Memory memory;
static SplatlinePixel pixels[ROWS * COLUMNS];
volatile int32_t result;

void reset(void) {
    result = draw_picture(&memory, SPLATLINE_LEAN18, SPLATLINE_TRAVERSAL_SPANS, WHOLE_FOOTPRINTS, pixels, COLUMNS);
    for (;;) {
    }
}

__attribute__((section(".vectors"), used)) static const void *const vectors[] = {stack_top, reset};
