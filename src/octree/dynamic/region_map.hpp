// RegionMap: maps regions of the octree's cells to boxes of coordinates, for searches by distance.
//
// Invariants
//   The box of a region contains each coordinate of the scene that the octree puts into a cell of the region. Slack covers the
//   roundings: of coordinates to float32 and to cells, and of this map.
//   The box is infinite at the border of the space, because border cells also hold all coordinates outside the space.
#pragma once

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <limits>

#include "octopair/objects.hpp"
#include "octree/plan/space.hpp"

namespace octopair {

/// A region of the space: first cell, and the cell after the last one, as real numbers that may be wrong by one cell.
struct CellRegion {
    std::array<double, 3> lo, hi;
};

class RegionMap {
public:
    /// `origin`: coordinates that become 0 in the octree's entries (OutwardRounding::origin).
    RegionMap(const Space& space, const std::array<double, 4>& origin) {
        for (unsigned axis = 0; axis < 3; ++axis) {
            const SpaceMap& map = space.map();
            const double cell = (1u << SpaceMap::fine_bits) / double(map.scale[axis]);
            const double origin_size = std::abs(double(map.origin[axis])), extent = cell * cells_per_axis;
            last_[axis] = double(space.last_cell(axis)) - spare_cells;
            // Differences beyond float32 are clamped. Then the axis cannot exclude a region.
            if (!(origin_size + extent < double(FLT_MAX) / 2)) continue;
            base_[axis] = origin[axis] + double(map.origin[axis]);
            cell_[axis] = cell;
            slack_[axis] = spare_cells * cell + float32_roundings * (2 * origin_size + extent) +
                           float64_roundings * (std::abs(origin[axis]) + origin_size + extent);
        }
    }

    Box3d box(const CellRegion& region) const {
        Box3d box;
        for (unsigned axis = 0; axis < 3; ++axis) {
            const double lo = base_[axis] + region.lo[axis] * cell_[axis] - slack_[axis];
            const double hi = base_[axis] + region.hi[axis] * cell_[axis] + slack_[axis];
            box.min[axis] = region.lo[axis] < spare_cells ? -infinity : lo;
            box.max[axis] = region.hi[axis] > last_[axis] ? infinity : hi;
        }
        return box;
    }

private:
    static constexpr double infinity = std::numeric_limits<double>::infinity();
    static constexpr double spare_cells = 2;  // one for the rounding to cells, one for that to the numbers of a unit
    static constexpr double float32_roundings = 0x1p-21;
    static constexpr double float64_roundings = 0x1p-48;

    std::array<double, 3> base_{}, cell_{}, last_{};
    std::array<double, 3> slack_{infinity, infinity, infinity};
};

}  // namespace octopair
