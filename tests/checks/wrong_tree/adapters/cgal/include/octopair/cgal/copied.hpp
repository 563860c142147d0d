// Breaks the rules of adapters: it uses the host, whose licence differs, and a header that is not public.
#pragma once

#include <CGAL/box_intersection_d.h>

#include "octree/scan/scan.hpp"
