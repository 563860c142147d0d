// A public header that uses private code, and one of a higher layer.
#pragma once

#include <hwy/highway.h>

#include "base/memory.hpp"
#include "octopair/engine.hpp"
