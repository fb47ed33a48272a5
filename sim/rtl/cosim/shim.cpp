// One verilated model behind four C functions. Compiled once for each model with MODEL (the class) and NAME (the model's name).
#include "model.h"

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)

namespace {

// Mirrors `Inputs` and `Outputs` of src/model.rs.
struct Inputs {
    uint8_t rst, table_valid, tile_valid, packet_valid, finish_valid, pixel_ready, lanes_enable, omit_finishing, wide_table, unit_negative, spare[2];
    uint16_t first_column, first_row, end_column, end_row;
    uint32_t alpha_max, minimum_transmittance, table_index, table_low, table_step;
    uint64_t least, unit_magnitude;
    uint16_t unit_shift, spare2;
    uint32_t packet[21];
};

struct Outputs {
    uint8_t tile_ready, packet_ready, finish_ready, pixel_valid, raster_idle, idle, finished, splat_begun, run_left, spare;
    uint16_t lanes_popped;
    uint32_t transmittance, red, green, blue, foreign_packets, root;
    uint8_t squared_valid, root_valid, normal_negative, padding;
    uint64_t squared, aligned;
    uint32_t normal;
    uint16_t normal_exponent, padding2;
};

// Mirrors `ReadOut` and `Drawn` of src/model.rs.
struct ReadOut {
    uint32_t finished, transmittance, red, green, blue;
};

struct Drawn {
    uint64_t cycles, raster_cycles;
};

struct Simulation {
    VerilatedContext context;
    MODEL model{&context, "top"};
};

// `mistake` picks one of those that the circuit was built with.
void* make(uint32_t seed, uint32_t mistake) {
    auto* simulation = new Simulation;
    pick_mistake(simulation->context, mistake);
    // Registers start with random bits: nothing may depend on a value before reset.
    simulation->context.randReset(2);
    simulation->context.randSeed(static_cast<int>(seed));
    return simulation;
}

void destroy(void* simulation) {
    static_cast<Simulation*>(simulation)->model.final();
    delete static_cast<Simulation*>(simulation);
}

void drive(MODEL& m, const Inputs* in) {
    m.rst = in->rst;
    m.table_valid = in->table_valid;
    m.tile_valid = in->tile_valid;
    m.packet_valid = in->packet_valid;
    m.finish_valid = in->finish_valid;
    m.pixel_ready = in->pixel_ready;
    m.lanes_enable = in->lanes_enable;
    m.omit_finishing = in->omit_finishing;
    m.wide_table = in->wide_table;
    m.first_column = in->first_column;
    m.first_row = in->first_row;
    m.end_column = in->end_column;
    m.end_row = in->end_row;
    m.alpha_max = in->alpha_max;
    m.least = in->least;
    m.unit_negative = in->unit_negative;
    m.unit_magnitude = in->unit_magnitude;
    m.unit_shift = in->unit_shift;
    m.minimum_transmittance = in->minimum_transmittance;
    m.table_index = in->table_index;
    m.table_low = in->table_low;
    m.table_step = in->table_step;
}

void offer(MODEL& m, const uint32_t* packet) {
    static_assert(sizeof(m.packet) <= sizeof(Inputs::packet), "a packet has at most 21 words");
    std::memcpy(&m.packet, packet, sizeof(m.packet));
}

// Drives the inputs, settles, samples the outputs as they stand before the edge, then clocks once.
void tick(void* simulation, const Inputs* in, Outputs* out) {
    auto& m = static_cast<Simulation*>(simulation)->model;
    drive(m, in);
    if (in->packet_valid) offer(m, in->packet);
    m.clk = 0;
    m.eval();
    *out = Outputs{m.tile_ready, m.packet_ready, m.finish_ready, m.pixel_valid, m.raster_idle, m.idle, m.finished, m.splat_begun, m.run_left, 0,
                   m.lanes_popped, m.transmittance, m.red, m.green, m.blue, m.foreign_packets, m.root,
                   m.squared_valid, m.root_valid, m.normal_negative, 0, m.squared, m.aligned, m.normal, m.normal_exponent, 0};
    m.clk = 1;
    m.eval();
}

// Cycles until the circuit answers; the cycle of the answer is counted. False if it never does.
template <typename Answer>
bool wait(MODEL& m, uint64_t& cycles, Answer answered) {
    for (uint32_t patience = 1u << 22; patience > 0; patience--) {
        m.clk = 0;
        m.eval();
        const bool now = answered();
        m.clk = 1;
        m.eval();
        cycles++;
        if (now) return true;
    }
    return false;
}

// A whole tile without a call for every cycle: the tile in `in`, packets of `Inputs::packet` words, as many pixels as the window has.
bool draw(void* simulation, const Inputs* in, const uint32_t* packets, size_t count, ReadOut* pixels, size_t pixel_count, Drawn* drawn) {
    auto& m = static_cast<Simulation*>(simulation)->model;
    uint64_t cycles = 0, taken = 0, idle = 0;
    drive(m, in);
    if (!wait(m, cycles, [&] { return m.tile_ready; })) return false;
    m.tile_valid = 0;
    m.packet_valid = 1;
    for (size_t i = 0; i < count; i++) {
        offer(m, packets + i * (sizeof(Inputs::packet) / sizeof(uint32_t)));
        if (!wait(m, cycles, [&] { return m.packet_ready; })) return false;
        if (i == 0) taken = cycles;
    }
    m.packet_valid = 0;
    if (!wait(m, cycles, [&] { return m.raster_idle; })) return false;
    idle = cycles;
    m.finish_valid = 1;
    if (!wait(m, cycles, [&] { return m.finish_ready; })) return false;
    m.finish_valid = 0;
    m.pixel_ready = 1;
    for (size_t i = 0; i < pixel_count; i++) {
        const auto read_out = [&] {
            pixels[i] = ReadOut{m.finished, m.transmittance, m.red, m.green, m.blue};
            return m.pixel_valid;
        };
        if (!wait(m, cycles, read_out)) return false;
    }
    m.pixel_ready = 0;
    *drawn = Drawn{cycles, count > 0 ? idle - taken : 0};
    return true;
}

}  // namespace

extern "C" {
void* JOIN(NAME, _make)(uint32_t seed, uint32_t mistake) { return make(seed, mistake); }
void JOIN(NAME, _destroy)(void* simulation) { destroy(simulation); }
void JOIN(NAME, _tick)(void* simulation, const Inputs* in, Outputs* out) { tick(simulation, in, out); }
bool JOIN(NAME, _draw)(void* simulation, const Inputs* in, const uint32_t* packets, size_t count, ReadOut* pixels, size_t pixel_count,
                       Drawn* drawn) {
    return draw(simulation, in, packets, count, pixels, pixel_count, drawn);
}
}
