
// Behind the generated files of one circuit: the functions that src/simulation.rs calls.
#include <string>

namespace {

struct Port {
    const char* name;
    void* data;
    uint32_t bits;
    bool is_input;
};

struct Simulation {
    VerilatedContext context;
    Circuit model;
    Simulation(uint32_t seed, uint32_t mutation) : model{prepared(seed, mutation), "top"} {}

    // Registers start with random bits: nothing may depend on a value before reset. Circuits without mutations do not
    // ask for one.
    VerilatedContext* prepared(uint32_t seed, uint32_t mutation) {
        const std::string argument = "+mutation=" + std::to_string(mutation);
        const char* arguments[] = {"circuit", argument.c_str()};
        context.commandArgs(2, arguments);
        context.randReset(2);
        context.randSeed(static_cast<int>(seed));
        return &context;
    }
};

}  // namespace

double sc_time_stamp() { return 0; }

extern "C" {
Simulation* circuit_make(uint32_t seed, uint32_t mutation) { return new Simulation(seed, mutation); }

void circuit_destroy(Simulation* simulation) {
    simulation->model.final();
    delete simulation;
}

void circuit_eval(Simulation* simulation, uint8_t clock) {
    simulation->model.clk = clock;
    simulation->model.eval();
}

// The circuit's port of this number; false behind the last one.
bool circuit_port(Simulation* simulation, size_t number, Port* port) {
    Circuit& model = simulation->model;
    const Port all[] = {
#include "ports.h"
    };
    if (number >= sizeof all / sizeof *all) return false;
    *port = all[number];
    return true;
}
}
