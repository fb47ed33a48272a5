// The scene: random splats of a linear congruential generator, so that the Rust test can draw the same.
#include "picture.h"

static uint32_t random_state;

static uint32_t random_bits(void) {
    random_state = random_state * 1664525u + 1013904223u;
    return random_state;
}

static void make_splats(SplatlineSplat *splats) {
    random_state = 1;
    for (int i = 0; i < SPLATS; i++) {
        SplatlineSplat *splat = &splats[i];
        for (int k = 0; k < 3; k++) {
            splat->centre[k].mantissa = ((int32_t)(random_bits() >> 8) - (1 << 23)) * 4; // [-2, 2)
            splat->centre[k].exponent = -24;
        }
        for (int axis = 0; axis < 3; axis++) {
            for (int k = 0; k < 3; k++) {
                splat->axes[axis].mantissa[k] = (int32_t)(random_bits() >> 1) - (1 << 30);
            }
            splat->axes[axis].exponent = -32 - (int32_t)(random_bits() >> 30);
        }
        splat->weight.mantissa = (int32_t)(random_bits() >> 2);
        splat->weight.exponent = -30;
        for (int k = 0; k < 3; k++) {
            splat->colour[k] = random_bits() >> 4; // [0, 1)
        }
    }
}

// A camera 4 units in front of the scene, looking along z.
static SplatlineView make_view(void) {
    SplatlineView view = {0};
    for (int k = 0; k < 3; k++) {
        view.rotation[4 * k] = 1 << 30;
    }
    view.eye[2] = -4;
    for (int axis = 0; axis < 2; axis++) {
        view.focal[axis].mantissa = 80 << 24;
        view.focal[axis].exponent = -24;
        view.ratio_low[axis] = -(int64_t)3435973837;
        view.ratio_high[axis] = 3435973837;
    }
    view.principal[0] = (int64_t)(COLUMNS / 2) << 32;
    view.principal[1] = (int64_t)(ROWS / 2) << 32;
    view.near_depth.mantissa = 180143985094820;
    view.near_depth.exponent = -54;
    view.far_depth.mantissa = 200;
    view.viewport[0] = COLUMNS;
    view.viewport[1] = ROWS;
    return view;
}

// Nearest first, ties by index.
static int sort_by_depth(Memory *memory) {
    int count = 0;
    for (int i = 0; i < SPLATS; i++) {
        if (memory->reasons[i] != SPLATLINE_OK) {
            continue;
        }
        int place = count++;
        for (; place > 0 && memory->footprints[memory->order[place - 1]].depth > memory->footprints[i].depth; place--) {
            memory->order[place] = memory->order[place - 1];
        }
        memory->order[place] = (uint16_t)i;
    }
    return count;
}

static int32_t step_through(const SplatlinePainter *painter, const SplatlineFootprint *footprint, const SplatlineWindow *window,
                            SplatlinePixel *pixels, size_t stride) {
    SplatlineSpans rows;
    SplatlineSpan run;
    int32_t status = splatline_spans_begin(&painter->widths, footprint, painter->traversal, window, &rows);
    if (status < 0) {
        return status;
    }
    while ((status = splatline_spans_next(&rows, &run)) > 0) {
        do {
            uint32_t opacity;
            status = splatline_pixel_opacity(painter, footprint, &run, &opacity);
            if (status < 0) {
                return status;
            }
            status = splatline_pixel_composite(painter, opacity, footprint->colour, &pixels[run.y * stride + run.x]);
            if (status < 0) {
                return status;
            }
        } while (splatline_span_step(&run) > 0);
    }
    return status;
}

static int32_t draw_tiles(const SplatlinePainter *painter, const SplatlineFootprint *footprint, uint16_t width, uint16_t height,
                          SplatlinePixel *pixels, size_t stride) {
    for (uint16_t y = 0; y < ROWS; y += height) {
        for (uint16_t x = 0; x < COLUMNS; x += width) {
            SplatlineWindow tile = {{x, y}, {(uint16_t)(x + width), (uint16_t)(y + height)}};
            size_t first = y * stride + x;
            size_t count = (height - 1) * stride + width;
            int32_t status = splatline_draw(painter, footprint, &tile, pixels + first, count, stride, 0);
            if (status < 0) {
                return status;
            }
        }
    }
    return SPLATLINE_OK;
}

// What goes down the wire of a chip: the footprint as a packet and back.
static int32_t through_packet(const SplatlineWidths *widths, uint32_t traversal, const SplatlineFootprint *footprint, SplatlineFootprint *received) {
    uint32_t packet[SPLATLINE_LONGEST_PACKET];
    size_t words;
    int32_t status = splatline_packet_words(widths, traversal, &words);
    if (status == SPLATLINE_OK) {
        status = splatline_packet_encode(widths, traversal, footprint, packet, words);
    }
    if (status == SPLATLINE_OK) {
        status = splatline_packet_decode(widths, traversal, packet, words, received);
    }
    return status;
}

static int32_t prepare(SplatlinePainter *painter, Memory *memory, uint32_t design, uint32_t traversal) {
    int32_t status = splatline_design(design, &painter->widths);
    if (status == SPLATLINE_OK) {
        status = splatline_rules(SPLATLINE_RULES_3DGS, &painter->rules);
    }
    if (status == SPLATLINE_OK) {
        status = splatline_table_entries(&painter->widths, &painter->table_count);
    }
    if (status == SPLATLINE_OK) {
        status = splatline_table_gaussian(&painter->widths, painter->rules.table_range, memory->table, painter->table_count);
    }
    painter->table = memory->table;
    painter->compositing = SPLATLINE_FRONT_TO_BACK;
    painter->traversal = traversal;
    return status;
}

int32_t prepare_picture(Memory *memory, uint32_t design, uint32_t traversal, SplatlinePainter *painter, int *visible) {
    SplatlineView view = make_view();
    int32_t status = prepare(painter, memory, design, traversal);
    if (status < 0) {
        return status;
    }
    make_splats(memory->splats);
    status = splatline_setup_many(&painter->widths, &view, &painter->rules, memory->splats, sizeof(SplatlineSplat), memory->footprints,
                                  sizeof(SplatlineFootprint), memory->reasons, SPLATS);
    *visible = status < 0 ? 0 : sort_by_depth(memory);
    return status;
}

int32_t draw_picture(Memory *memory, uint32_t design, uint32_t traversal, enum Way way, SplatlinePixel *pixels, size_t stride) {
    SplatlinePainter painter;
    SplatlineWindow window = {{0, 0}, {COLUMNS, ROWS}};
    int visible;
    int32_t status = prepare_picture(memory, design, traversal, &painter, &visible);
    if (status < 0) {
        return status;
    }
    size_t count = (ROWS - 1) * stride + COLUMNS;
    status = splatline_clear(&painter.widths, pixels, count);
    for (int i = 0; i < visible && status >= 0; i++) {
        SplatlineFootprint footprint;
        status = through_packet(&painter.widths, painter.traversal, &memory->footprints[memory->order[i]], &footprint);
        if (status < 0) {
            return status;
        }
        if (way == WHOLE_FOOTPRINTS) {
            status = splatline_draw(&painter, &footprint, &window, pixels, count, stride, 0);
        } else if (way == TILES) {
            status = draw_tiles(&painter, &footprint, 16, 8, pixels, stride);
        } else {
            status = step_through(&painter, &footprint, &window, pixels, stride);
        }
    }
    return status;
}
