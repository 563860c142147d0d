// NearestSearch: passes the near objects of a MutableOctree to a visitor, and visits nearer regions first.
//
// A visitor has these functions:
//   double at_least(const Box3d& region) const   a lower bound on the distance to each object whose box reaches into `region`, which may be
//                                                infinite; a value above limit() if none of these objects is wanted. Any monotone
//                                                function of the distance serves, such as its square.
//   double limit() const                         the value of at_least() beyond which objects are not wanted. May shrink during the search.
//   CellBox reach() const                        cells that overlap those of each object within limit(); all_cells if it is not known.
//   void take(std::uint32_t object)              receives an object that may be within limit(), possibly several times.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <utility>

#include "octree/dynamic/mutable_octree.hpp"

namespace octopair {

template <typename Visitor>
class NearestSearch {
public:
    /// `home`: the cell at which the search begins. It only decides the order of visits: regions around it are visited first.
    NearestSearch(const MutableOctree& octree, const RegionMap& map, const Cell& home, Visitor& visitor)
        : octree_(octree), map_(map), home_(home), visitor_(visitor) {}

    void run() {
        if (octree_.empty()) return;
        // The unit around `home` usually holds near objects, so the search leaves out most of the others.
        const Unit first = octree_.unit_at(home_);
        visit_unit(first);
        first_unit_ = first.index;
        visit_octant(0);
    }

private:
    bool is_wanted(const CellRegion& region) const { return visitor_.at_least(map_.box(region)) <= visitor_.limit(); }

    const CellBox& reach() {
        if (visitor_.limit() < limit_of_reach_) {
            limit_of_reach_ = visitor_.limit();
            reach_ = visitor_.reach();
        }
        return reach_;
    }

    /// Visits the child around `home_` first, then its neighbours on the short axes, then those on the long axis.
    void visit_octant(OctantIndex index) {
        const LeafGrid& grid = octree_.grids_[index];
        if (grid.used) visit_unit(grid.own_unit());
        if (!grid.inner) return visit_cells(grid, grid.all());
        const Octant& octant = octree_.directory_.octants()[index];
        const OctantCube cube{octant.lo, octant.level};
        const unsigned long_axis = octree_.space_.long_axis(), home = cube.digit(home_);
        for (unsigned step = 0; step < 8; ++step) {
            unsigned digit = home;
            // Bit 2 of `step` is the long axis.
            for (unsigned bit = 0; bit < 3; ++bit) digit ^= (step >> bit & 1) << (long_axis + 1 + bit) % 3;
            if ((cube.touched_below(reach()) >> digit & 1) == 0) continue;
            const OctantIndex child = octree_.directory_.child(octant, digit);
            if (is_wanted(octree_.grids_[child].region())) visit_octant(child);
        }
    }

    /// Visits the cells of a range that are near enough. Halves a large range, and visits the half at `home_` first.
    void visit_cells(const LeafGrid& leaf, const GridRange& all) {
        if (!leaf.touches(reach())) return;
        const GridRange range = all.common(leaf.range_of(reach()));
        unsigned axis = 0;
        for (unsigned other = 1; other < 3; ++other) {
            if (range.length(other) > range.length(axis)) axis = other;
        }
        if (range.length(axis) <= 2) {
            leaf.for_each_cell(range, [&](const Unit& unit, const auto& at) {
                if (is_wanted(leaf.region({at, at}))) visit_unit(unit);
            });
            return;
        }
        GridRange near = range, far = range;
        near.last[axis] = range.first[axis] + range.length(axis) / 2 - 1;
        far.first[axis] = near.last[axis] + 1;
        if (home_[axis] >= leaf.first_cell(axis, far.first[axis])) std::swap(near, far);
        if (is_wanted(leaf.region(near))) visit_cells(leaf, near);
        if (is_wanted(leaf.region(far))) visit_cells(leaf, far);
    }

    void visit_unit(const Unit& unit) {
        if (unit.index == first_unit_) return;
        SmallBox wanted = unit.small(reach());
        wanted.begin_inside();
        octree_.units_.for_each(unit.index, wanted, [&](const SmallBox& box, std::uint32_t object) {
            if (is_wanted(unit.region(box))) visitor_.take(object);
        });
    }

    const MutableOctree& octree_;
    const RegionMap& map_;
    const Cell home_;
    Visitor& visitor_;
    std::uint32_t first_unit_ = ~std::uint32_t(0);
    CellBox reach_ = all_cells;  // cells of objects within limit_of_reach_
    double limit_of_reach_ = std::numeric_limits<double>::infinity();
};

}  // namespace octopair
