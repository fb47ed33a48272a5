// DPI-C: the kernel as functions that a SystemVerilog bench imports. The state lives here because SystemVerilog has no pointers.
#include "picture.h"

static Memory memory;
static SplatlinePainter painter;
static SplatlineRows rows;
static SplatlineRun run;
static int visible;
static int next_footprint;

static int begin_footprint(void) {
    SplatlineWindow window = {{0, 0}, {COLUMNS, ROWS}};
    if (next_footprint >= visible) {
        return 0;
    }
    const SplatlineFootprint *footprint = &memory.footprints[memory.order[next_footprint++]];
    int32_t status = splatline_rows_begin(&painter.widths, footprint, painter.traversal, &window, &rows);
    return status < 0 ? status : 1;
}

// 1, or an error below 0.
int model_begin(void) {
    int32_t status = prepare_picture(&memory, SPLATLINE_STANDARD24, SPLATLINE_TRAVERSAL_SPANS, &painter, &visible);
    next_footprint = 0;
    return status < 0 ? status : begin_footprint();
}

// The next run's seed: 1, 0 at the end of the picture, or an error below 0.
int model_next_run(int *radial, int *first, int *second, int *length) {
    int32_t status;
    while ((status = splatline_rows_next(&rows, &run)) == SPLATLINE_OK) {
        status = begin_footprint();
        if (status <= 0) {
            return status;
        }
    }
    *radial = (int)run.radial;
    *first = (int)run.first;
    *second = (int)run.second;
    *length = run.length;
    return status;
}

// The radial index at the present pixel; moves on to the next.
int model_pixel(void) {
    int radial = (int)run.radial;
    splatline_run_step(&run);
    return radial;
}
