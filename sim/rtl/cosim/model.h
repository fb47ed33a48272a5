// What the shims stand on: the verilated class MODEL, whose header has its name.
#pragma once
#include <cstdint>
#include <cstring>
#include <string>
#include "verilated.h"

#define TEXT_(a) #a
#define TEXT(a) TEXT_(a)
#define HEADER_(a) TEXT(a.h)
#define HEADER HEADER_(MODEL)
#include HEADER

// Of a circuit that was built with several mistakes: which of them it makes. Circuits without any do not ask.
inline void pick_mistake(VerilatedContext& context, uint32_t mistake) {
    const std::string argument = "+mistake=" + std::to_string(mistake);
    const char* arguments[] = {"circuit", argument.c_str()};
    context.commandArgs(2, arguments);
}
