// A folder of the octree that uses one of a later step.
#pragma once

#include "octree/scan/scan.hpp"
