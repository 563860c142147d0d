// A public header that includes private code and a header of a higher layer.
#pragma once

#include <hwy/highway.h>

#include "base/memory.hpp"
#include "octopair/engine.hpp"
