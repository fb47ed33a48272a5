// Firmware in 40 lines: Gaussians in ordinary numbers, drawn in strips of eight rows and sent to a display. Here the
// display is a file.
#include "splatline.h"
#include <stdio.h>

enum { COLUMNS = 160, ROWS = 128, STRIP = 8, SPLATS = 3 };

static SplatlineSplat splats[SPLATS];
static uint32_t list[SPLATS * 11]; // splatline_list_words(SPLATS)
static SplatlinePixel pixels[COLUMNS * STRIP];
static uint16_t sent[COLUMNS * STRIP];

int main(int arguments, char **argument) {
    static const float eye[3] = {0, -1, -4}, target[3] = {0, 0, 0}, up[3] = {0, -1, 0};
    static const float rotation[4] = {1, 0, 0, 0};
    static const float means[SPLATS][3] = {{0, 0, 0}, {0.8f, 0, 0.5f}, {-0.7f, 0.2f, -0.4f}};
    static const float scales[SPLATS][3] = {{0.4f, 0.4f, 0.4f}, {0.1f, 0.6f, 0.1f}, {0.5f, 0.02f, 0.3f}};
    static const float colours[SPLATS][3] = {{1, 0.5f, 0.1f}, {0.1f, 0.4f, 1}, {0.3f, 1, 0.4f}};
    SplatlineView view;
    FILE *display = arguments == 2 ? fopen(argument[1], "wb") : NULL;
    if (!display || splatline_look_at(eye, target, up, 40, COLUMNS, ROWS, &view) < 0) {
        return 1;
    }
    for (int i = 0; i < SPLATS; i++) { // Once.
        if (splatline_gaussian(means[i], rotation, scales[i], 0.9f, colours[i], &splats[i]) < 0) {
            return 1;
        }
    }
    int32_t count = splatline_set_up_scene(&view, splats, SPLATS, list, SPLATS * 11, NULL); // For every picture.
    for (uint16_t y = 0; count >= 0 && y < ROWS; y += STRIP) {
        SplatlineWindow window = {{0, y}, {COLUMNS, (uint16_t)(y + STRIP)}};
        int32_t status = splatline_draw_rgb565(list, SPLATS * 11, (size_t)count, &window, 0x0883, pixels, sent, COLUMNS * STRIP);
        if (status < 0) {
            fprintf(stderr, "%s\n", splatline_error_text(status));
            return 1;
        }
        fwrite(sent, sizeof sent[0], COLUMNS * STRIP, display);
    }
    return fclose(display) || count < 0;
}
