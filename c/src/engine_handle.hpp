// The engine behind a handle. Jobs share it.
#pragma once

#include <memory>

#include "octopair.h"
#include "octopair/engine.hpp"

struct octopair_engine {
    std::unique_ptr<octopair::Engine> engine;
};
