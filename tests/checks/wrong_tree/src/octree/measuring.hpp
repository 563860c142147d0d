// A layer that uses a benchmark.
#pragma once

#include "paper/study.hpp"
