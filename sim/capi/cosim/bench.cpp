// C++ bench: the verilated splat primitive (design standard24) against the kernel, every word of the example picture's
// tiles. Your own rasterizer takes its place: feed it what `tiles.h` offers and compare what it has drawn.
#include "Vflat_primitive.h"
#include "tiles.h"
#include <cstdio>
#include <cstring>
#include <memory>

static const int PATIENCE = 1000000; // cycles within which a handshake must come

// One clock cycle. Outputs are read between the two halves: they belong to the inputs of this cycle.
static void settle(Vflat_primitive &circuit) {
    circuit.clk = 0;
    circuit.eval();
}

static void edge(Vflat_primitive &circuit) {
    circuit.clk = 1;
    circuit.eval();
}

// Cycles until `ready` is set, and one more, in which what is offered is taken.
static bool handshake(Vflat_primitive &circuit, const CData &ready) {
    for (int cycle = 0; cycle < PATIENCE; cycle++) {
        settle(circuit);
        bool taken = ready;
        edge(circuit);
        if (taken) {
            return true;
        }
    }
    std::printf("the circuit hangs\n");
    return false;
}

static void start(Vflat_primitive &circuit, const Bench &bench) {
    circuit.rst = 1;
    for (int cycle = 0; cycle < 4; cycle++) {
        settle(circuit);
        edge(circuit);
    }
    circuit.rst = 0;
    circuit.lanes_enable = 1;
    circuit.alpha_max = bench.rules.alpha_max;
    circuit.least = bench.rules.least;
    circuit.minimum_transmittance = bench.rules.minimum_transmittance;
    circuit.omit_finishing = bench.rules.omit_finishing;
    circuit.wide_table = bench.rules.wide_table;
    circuit.table_valid = 1;
    for (uint32_t index = 0; index < bench.painter.table_count; index++) {
        uint32_t low, step;
        bench_table(&bench, index, &low, &step);
        circuit.table_index = index;
        circuit.table_low = low;
        circuit.table_step = step;
        settle(circuit);
        edge(circuit);
    }
    circuit.table_valid = 0;
}

// The tile's window, then all packets, nearest first, then the end.
static bool draw(Vflat_primitive &circuit, const Bench &bench, const SplatlineWindow &tile) {
    circuit.first_column = tile.first[0];
    circuit.first_row = tile.first[1];
    circuit.end_column = tile.end[0];
    circuit.end_row = tile.end[1];
    circuit.tile_valid = 1;
    bool done = handshake(circuit, circuit.tile_ready);
    circuit.tile_valid = 0;
    circuit.packet_valid = 1;
    for (int i = 0; i < bench.visible && done; i++) {
        uint32_t words[SPLATLINE_LONGEST_PACKET];
        done = bench_packet(&bench, i, words) >= 0;
        std::memcpy(&circuit.packet, words, sizeof circuit.packet);
        done = done && handshake(circuit, circuit.packet_ready);
    }
    circuit.packet_valid = 0;
    circuit.finish_valid = 1;
    done = done && handshake(circuit, circuit.finish_ready);
    circuit.finish_valid = 0;
    return done;
}

// Reads the tile out, row by row, and compares. Returns the number of pixels, or -1.
static long compare(Vflat_primitive &circuit, const Bench &bench, const SplatlineWindow &tile) {
    long pixels = 0;
    for (int y = tile.first[1]; y < tile.end[1]; y++) {
        for (int x = tile.first[0]; x < tile.end[0]; x++, pixels++) {
            circuit.pixel_ready = 0;
            do {
                settle(circuit);
                if (!circuit.pixel_valid) {
                    edge(circuit);
                }
            } while (!circuit.pixel_valid);
            const uint32_t colour[3] = {circuit.red, circuit.green, circuit.blue};
            if (!bench_pixel_is(&bench, x, y, circuit.finished, circuit.transmittance, colour)) {
                std::printf("pixel (%d, %d): the circuit has %08x %08x %08x, transmittance %08x\n", x, y, colour[0], colour[1], colour[2],
                            (unsigned)circuit.transmittance);
                return -1;
            }
            circuit.pixel_ready = 1;
            settle(circuit);
            edge(circuit);
        }
    }
    circuit.pixel_ready = 0;
    return pixels;
}

int main() {
    auto bench = std::make_unique<Bench>();
    auto circuit = std::make_unique<Vflat_primitive>();
    int32_t status = bench_prepare(bench.get(), SPLATLINE_STANDARD24);
    if (status < 0) {
        std::printf("%s\n", splatline_error_text(status));
        return 1;
    }
    start(*circuit, *bench);
    long pixels = 0;
    for (int i = 0; i < TILE_COUNT; i++) {
        SplatlineWindow tile = bench_tile(i);
        long compared = draw(*circuit, *bench, tile) ? compare(*circuit, *bench, tile) : -1;
        if (compared < 0) {
            return 1;
        }
        pixels += compared;
    }
    std::printf("C++ bench: %ld pixels, 0 mismatches\n", pixels);
    return 0;
}
