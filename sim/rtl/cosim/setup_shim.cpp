// The verilated setup unit behind three C functions. MODEL is its class.
#include "model.h"

namespace {

// Mirrors `Inputs` and `Outputs` of src/setup/model.rs.
struct Inputs {
    uint8_t rst, constant_valid, constant_index, record_valid, packet_ready, spare[3];
    uint64_t constant_value;
    uint32_t constant_exponent;
    uint32_t record[19];
};

struct Outputs {
    uint8_t record_ready, packet_valid, cull, spare;
    uint32_t packet[21];
};

struct Simulation {
    VerilatedContext context;
    MODEL model{&context, "top"};
};

}  // namespace

// `mistake` picks one of those that the circuit was built with.
extern "C" void* setup_make(uint32_t seed, uint32_t mistake) {
    auto* simulation = new Simulation;
    pick_mistake(simulation->context, mistake);
    // Registers start with random bits: nothing may depend on a value before reset.
    simulation->context.randReset(2);
    simulation->context.randSeed(static_cast<int>(seed));
    return simulation;
}

extern "C" void setup_destroy(void* simulation) {
    static_cast<Simulation*>(simulation)->model.final();
    delete static_cast<Simulation*>(simulation);
}

extern "C" void setup_tick(void* simulation, const Inputs* in, Outputs* out) {
    MODEL& m = static_cast<Simulation*>(simulation)->model;
    m.rst = in->rst;
    m.constant_valid = in->constant_valid;
    m.constant_index = in->constant_index;
    m.constant_value = in->constant_value;
    m.constant_exponent = in->constant_exponent & 0x3ffff;
    m.record_valid = in->record_valid;
    m.packet_ready = in->packet_ready;
    std::memcpy(&m.record, in->record, sizeof m.record);
    m.clk = 0;
    m.eval();
    out->record_ready = m.record_ready;
    out->packet_valid = m.packet_valid;
    out->cull = m.cull;
    std::memcpy(out->packet, &m.packet, sizeof m.packet);
    m.clk = 1;
    m.eval();
}
