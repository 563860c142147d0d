// A check that uses what it checks.
#pragma once

#include "octree/scan.hpp"
