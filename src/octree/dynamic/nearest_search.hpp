// NearestSearch: passes the near objects of a MutableOctree to a visitor, and visits nearer regions first.
//
// A visitor has these functions:
//   double at_least(const Box3d& region) const   a lower bound on the distance to each object whose box reaches into `region`, which may be
//                                                infinite; a value above limit() if none of these objects is wanted. Any monotone
//                                                function of the distance serves, such as its square.
//   double limit() const                         the value of at_least() beyond which objects are not wanted. May shrink during the search.
//   void take(std::uint32_t object)              receives an object that may be within limit(), possibly several times.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "octree/dynamic/mutable_octree.hpp"

namespace octopair {

template <typename Visitor>
class NearestSearch {
public:
    NearestSearch(const MutableOctree& octree, const RegionMap& map, Visitor& visitor)
        : octree_(octree), map_(map), visitor_(visitor) {}

    void run() {
        if (!octree_.empty()) visit_octant(0);
    }

private:
    double at_least(const CellRegion& region) const { return visitor_.at_least(map_.box(region)); }

    void visit_octant(OctantIndex octant) {
        const LeafGrid& grid = octree_.grids_[octant];
        if (grid.used) visit_unit(grid.own_unit());
        if (!grid.inner) return visit_cells(grid, grid.all());
        std::array<std::pair<double, OctantIndex>, 8> children;
        const Directory& directory = octree_.directory_;
        for (unsigned digit = 0; digit < 8; ++digit) {
            const OctantIndex child = directory.child(directory.octants()[octant], digit);
            children[digit] = {at_least(octree_.grids_[child].region()), child};
        }
        std::sort(children.begin(), children.end());
        for (const auto& [distance, child] : children) {
            if (distance <= visitor_.limit()) visit_octant(child);
        }
    }

    /// Visits the cells of a range that are near enough. Halves the range until it is one cell, and visits the nearer half first.
    void visit_cells(const LeafGrid& leaf, const GridRange& range) {
        unsigned axis = 0;
        for (unsigned other = 1; other < 3; ++other) {
            if (range.last[other] - range.first[other] > range.last[axis] - range.first[axis]) axis = other;
        }
        if (range.first[axis] == range.last[axis]) {
            leaf.for_each_cell(range, [&](const Unit& unit, const auto&) { visit_unit(unit); });
            return;
        }
        GridRange low = range, high = range;
        low.last[axis] = range.first[axis] + (range.last[axis] - range.first[axis]) / 2;
        high.first[axis] = low.last[axis] + 1;
        double at_low = at_least(leaf.region(low));
        double at_high = at_least(leaf.region(high));
        if (at_high < at_low) {
            std::swap(at_low, at_high);
            std::swap(low, high);
        }
        if (at_low <= visitor_.limit()) visit_cells(leaf, low);
        if (at_high <= visitor_.limit()) visit_cells(leaf, high);
    }

    void visit_unit(const Unit& unit) {
        octree_.units_.for_each(unit.index, [&](const SmallBox& box, std::uint32_t object) {
            if (at_least(unit.region(box)) <= visitor_.limit()) visitor_.take(object);
        });
    }

    const MutableOctree& octree_;
    const RegionMap& map_;
    Visitor& visitor_;
};

}  // namespace octopair
