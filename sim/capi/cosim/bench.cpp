// C++ bench: the verilated lane against the kernel, pixel by pixel, over all runs of the example picture (design standard24).
#include "Vrun_lane.h"
#include "picture.h"
#include <cstdio>
#include <memory>

static void tick(Vrun_lane &lane) {
    lane.clock = 0;
    lane.eval();
    lane.clock = 1;
    lane.eval();
}

int main() {
    auto memory = std::make_unique<Memory>();
    auto lane = std::make_unique<Vrun_lane>();
    SplatlinePainter painter;
    int visible;
    int32_t status = prepare_picture(memory.get(), SPLATLINE_STANDARD24, SPLATLINE_TRAVERSAL_SPANS, &painter, &visible);
    long pixels = 0;
    SplatlineWindow window = {{0, 0}, {COLUMNS, ROWS}};
    for (int i = 0; i < visible && status >= 0; i++) {
        const SplatlineFootprint *footprint = &memory->footprints[memory->order[i]];
        SplatlineRows rows;
        SplatlineRun run;
        status = splatline_rows_begin(&painter.widths, footprint, painter.traversal, &window, &rows);
        while (status >= 0 && (status = splatline_rows_next(&rows, &run)) > 0) {
            lane->load = 1;
            lane->step = 0;
            lane->seed_radial = (uint32_t)run.radial;
            lane->seed_first = (uint32_t)run.first;
            lane->seed_second = (uint32_t)run.second;
            tick(*lane);
            lane->load = 0;
            lane->step = 1;
            do {
                if (lane->radial != (uint32_t)run.radial) {
                    std::printf("splat %d, row %d, column %d: expected %08x, got %08x\n", memory->order[i], run.y, run.x,
                                (unsigned)run.radial, (unsigned)lane->radial);
                    return 1;
                }
                pixels++;
                tick(*lane);
            } while (splatline_run_step(&run) > 0);
        }
    }
    if (status < 0) {
        std::printf("%s\n", splatline_error_text(status));
        return 1;
    }
    std::printf("C++ bench: %ld pixels, 0 mismatches\n", pixels);
    return pixels > 0 ? 0 : 1;
}
