// The verilated machine with a memory, behind one C function. MODEL is its class.
#include "model.h"
#include "memory.h"

namespace {

// Mirror the structs of src/machine/model.rs.
struct Constant {
    uint64_t value;
    uint32_t exponent, index;
};

struct Entry {
    uint32_t low, step;
};

struct Frame {
    uint64_t least;
    uint32_t alpha_max, minimum_transmittance, omit_finishing, wide_table;
    uint32_t records, base_records, base_packets, base_a, base_b, base_lists, base_frame, most, columns, rows, latency, pauses, bytes;
};

struct Outcome {
    uint32_t full, visible, entries, hangs;
    uint64_t geometry, sort, fill, raster, read, written, beyond;
};

}  // namespace

// Draws the frame `rounds` times, one after the other in one machine; the cycles of the last one count. `mistake` picks one of those that the machine
// was built with.
extern "C" void machine_run(uint32_t seed, uint32_t mistake, const Frame* frame, const Constant* constants, uint64_t constant_count, const Entry* table,
                            uint64_t table_count, uint32_t* words, uint64_t size, uint32_t rounds, Outcome* out) {
    VerilatedContext context;
    context.randReset(2);
    context.randSeed(static_cast<int>(seed));
    pick_mistake(context, mistake);
    MODEL m{&context, "top"};
    Memory memory{words, size, frame->latency, frame->pauses, seed, frame->bytes};
    Clocked<MODEL> clocked{m, memory};
    m.constant_valid = m.table_valid = m.begins = 0;
    m.alpha_max = frame->alpha_max;
    m.least = frame->least;
    m.minimum_transmittance = frame->minimum_transmittance;
    m.omit_finishing = frame->omit_finishing;
    m.wide_table = frame->wide_table;
    m.records = frame->records;
    m.base_records = frame->base_records;
    m.base_packets = frame->base_packets;
    m.base_a = frame->base_a;
    m.base_b = frame->base_b;
    m.base_lists = frame->base_lists;
    m.base_frame = frame->base_frame;
    m.most = frame->most;
    m.columns = frame->columns;
    m.rows = frame->rows;
    m.rst = 1;
    for (int i = 0; i < 4; i++) clocked.tick(), clocked.edge(), memory.reset();
    m.rst = 0;
    for (uint64_t i = 0; i < constant_count; i++) {
        m.constant_valid = 1;
        m.constant_index = constants[i].index;
        m.constant_value = constants[i].value;
        m.constant_exponent = constants[i].exponent & 0x3ffff;
        clocked.tick(), clocked.edge();
    }
    m.constant_valid = 0;
    for (uint64_t i = 0; i < table_count; i++) {
        m.table_valid = 1;
        m.table_index = i;
        m.table_low = table[i].low;
        m.table_step = table[i].step;
        clocked.tick(), clocked.edge();
    }
    m.table_valid = 0;
    // The tile buffers are cleared once.
    for (int i = 0; i < 1100; i++) clocked.tick(), clocked.edge();
    for (uint32_t round = 0; round < rounds; round++) {
        *out = Outcome{};
        const uint64_t read = memory.read, written = memory.written;
        uint32_t patience = 1u << 18;
        // A circuit that goes on reading and writing hangs as well.
        const uint64_t start = memory.now;
        const uint64_t limit = (1u << 18) + 1000 * uint64_t(frame->records) + 1100 * uint64_t(frame->most) + 16 * uint64_t(frame->columns) * frame->rows;
        m.begins = 1;
        clocked.tick(), clocked.edge();
        m.begins = 0;
        for (;;) {
            clocked.tick();
            const int phase = m.phase;
            if (phase == 1) out->geometry++;
            if (phase == 2) (m.listing ? out->fill : out->sort)++;
            if (phase == 3) out->raster++;
            const uint64_t moved = memory.read + memory.written;
            clocked.edge();
            patience = memory.read + memory.written != moved ? 1u << 18 : patience - 1;
            if (phase == 0 || patience == 0 || memory.now - start > limit) {
                out->hangs = phase != 0;
                break;
            }
        }
        out->read = memory.read - read;
        out->written = memory.written - written;
        if (out->hangs) return;
    }
    // What was written last is on its way for a while.
    for (uint32_t i = 0; i <= frame->latency; i++) clocked.tick(), clocked.edge();
    out->full = m.full;
    out->visible = m.visible;
    out->entries = m.entries;
    out->beyond = memory.beyond;
    m.final();
}
