// A verifier that includes the code under verification.
// Start here to change what no table names.
#pragma once

#include "octree/scan/scan.hpp"
