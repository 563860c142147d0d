// Breaks the rule that the Python package uses only public headers.
#include "octree/scan/scan.hpp"
