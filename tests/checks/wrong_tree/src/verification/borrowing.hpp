// A verifier that includes the code under verification.
#pragma once

#include "octree/scan.hpp"
