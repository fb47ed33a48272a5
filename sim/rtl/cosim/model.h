// What the shims stand on: the verilated class MODEL, whose header has its name.
#pragma once
#include <cstdint>
#include <cstring>
#include "verilated.h"

#define TEXT_(a) #a
#define TEXT(a) TEXT_(a)
#define HEADER_(a) TEXT(a.h)
#define HEADER HEADER_(MODEL)
#include HEADER
