#include <hwy/highway.h>

#include "base/memory.hpp"
