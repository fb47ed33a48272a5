// The verilated sorter with its binning and a memory, behind one C function. MODEL is its class.
#include "model.h"
#include "memory.h"

// Mirrors `Picture` and `Outcome` of src/order/model.rs.
struct Picture {
    uint32_t base_a, base_b, base_lists, tile_columns, tiles, most, latency, pauses, interval, rounds;
};

struct Outcome {
    uint32_t splats, entries, sorted, full, hangs, spare;
    uint64_t taken, done, read, written, beyond;
};

// Orders splats of four words each; `ends` gets the end of each tile's list. All of it `rounds` times, of which the last counts.
extern "C" void order_run(uint32_t seed, const Picture* picture, const uint32_t* splats, uint64_t count, uint32_t* words, uint64_t size,
                          uint32_t* ends, Outcome* out) {
    VerilatedContext context;
    context.randReset(2);
    context.randSeed(static_cast<int>(seed));
    MODEL m{&context, "top"};
    Memory memory{words, size, picture->latency, picture->pauses, seed};
    Clocked<MODEL> clocked{m, memory};
    m.base_a = picture->base_a;
    m.base_b = picture->base_b;
    m.base_lists = picture->base_lists;
    m.tile_columns = picture->tile_columns;
    m.tiles = picture->tiles;
    m.most = picture->most;
    m.begins = m.in_valid = m.ends = 0;
    m.rst = 1;
    for (int i = 0; i < 4; i++) clocked.tick(), clocked.edge(), memory.reset();
    m.rst = 0;
    *out = Outcome{};
    for (uint32_t round = 0; round < picture->rounds; round++) {
        m.begins = 1;
        clocked.tick(), clocked.edge();
        m.begins = 0;
        const uint64_t start = memory.now, read = memory.read, written = memory.written;
        uint64_t taken = 0, next = 0, patience = 1u << 17;
        // A circuit that goes on reading and writing hangs as well.
        const uint64_t limit = (1u << 17) + 200 * count + 16 * uint64_t(picture->most);
        m.ends = 0;
        for (;;) {
            m.in_valid = taken < count && memory.now >= next;
            m.ends = taken == count;
            if (m.in_valid) std::memcpy(&m.in, splats + 4 * taken, 16);
            clocked.tick();
            const bool goes = m.in_valid && m.in_ready, done = m.done;
            const uint64_t moved = memory.read + memory.written;
            clocked.edge();
            if (goes) {
                taken++;
                next = memory.now - 1 + picture->interval;
                if (taken == count) out->taken = memory.now - start;
            }
            patience = goes || memory.read + memory.written != moved ? 1u << 17 : patience - 1;
            if (done || patience == 0 || memory.now - start > limit) {
                out->hangs = !done;
                break;
            }
        }
        out->done = memory.now - start;
        out->read = memory.read - read;
        out->written = memory.written - written;
        if (out->hangs) return;
    }
    for (uint32_t tile = 0; tile < picture->tiles; tile++) {
        m.end_tile = tile;
        clocked.tick(), clocked.edge();
        ends[tile] = m.end_place;
    }
    out->splats = m.splats;
    out->entries = m.entries;
    out->sorted = m.sorted;
    out->full = m.full;
    out->beyond = memory.beyond;
    m.final();
}
