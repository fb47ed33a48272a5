// The verilated harmonics unit behind three C functions. MODEL is its class.
#include "model.h"

namespace {

// Mirrors `HarmonicsInputs` and `HarmonicsOutputs` of src/harmonics/model.rs.
struct Inputs {
    uint8_t rst, splat_valid, degree, word_valid, colour_ready, spare[3];
    uint32_t direction[3], word[3];
};

struct Outputs {
    uint8_t splat_ready, word_ready, colour_valid, spare;
    uint32_t colour[3];
};

struct Simulation {
    VerilatedContext context;
    MODEL model{&context, "top"};
};

}  // namespace

// `mistake` picks one of those that the circuit was built with.
extern "C" void* harmonics_make(uint32_t seed, uint32_t mistake) {
    auto* simulation = new Simulation;
    pick_mistake(simulation->context, mistake);
    // Registers start with random bits: nothing may depend on a value before reset.
    simulation->context.randReset(2);
    simulation->context.randSeed(static_cast<int>(seed));
    return simulation;
}

extern "C" void harmonics_destroy(void* simulation) {
    static_cast<Simulation*>(simulation)->model.final();
    delete static_cast<Simulation*>(simulation);
}

extern "C" void harmonics_tick(void* simulation, const Inputs* in, Outputs* out) {
    MODEL& m = static_cast<Simulation*>(simulation)->model;
    m.rst = in->rst;
    m.splat_valid = in->splat_valid;
    m.degree = in->degree;
    m.word_valid = in->word_valid;
    m.colour_ready = in->colour_ready;
    std::memcpy(&m.direction, in->direction, sizeof in->direction);
    std::memcpy(&m.word, in->word, sizeof in->word);
    m.clk = 0;
    m.eval();
    out->splat_ready = m.splat_ready;
    out->word_ready = m.word_ready;
    out->colour_valid = m.colour_valid;
    std::memcpy(out->colour, &m.colour, sizeof out->colour);
    m.clk = 1;
    m.eval();
}
