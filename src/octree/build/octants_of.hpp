// Finds the octants of a linear octree that get an entry of a box.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>

#include "octree/plan/directory.hpp"

namespace octopair {

/// True if `box` lies within the octant of `level` that holds its low corner.
inline bool within(const CellBox& box, unsigned level) {
    return ((box.lo[0] ^ box.hi[0]) | (box.lo[1] ^ box.hi[1]) | (box.lo[2] ^ box.hi[2])) >> (deepest - level) == 0;
}

/// Returns a bit mask of the axes on which `box` touches more than one octant of `level`.
inline unsigned crossed_axes(const CellBox& box, unsigned level) {
    const unsigned shift = deepest - level;
    unsigned crossed = 0;
    for (unsigned axis = 0; axis < 3; ++axis) {
        crossed |= unsigned(box.lo[axis] >> shift != box.hi[axis] >> shift) << axis;
    }
    return crossed;
}

inline Cell corner_of(const CellBox& box, unsigned corner) {
    Cell cell = box.lo;
    for (unsigned axis = 0; axis < 3; ++axis) {
        if (corner >> axis & 1u) cell[axis] = box.hi[axis];
    }
    return cell;
}

/// Calls place(octant, class bits) for each octant that gets an entry of `box`, first for the octant that the box begins in.
/// `home`: the leaf that the box begins in. At the natural level of a box and above, each octant that the box touches holds a
/// corner of the box. A coarser leaf may hold several corners. Then place() is called for the lowest of these corners only.
/// Requires: `box` reaches beyond `home`.
template <typename Place>
void for_each_octant_of(const CellBox& box, const Directory& directory, Directory::Leaf home, Place&& place) {
    const unsigned natural = natural_level(box);
    std::array<std::pair<unsigned, OctantIndex>, 8> corners;
    std::size_t count = 0;
    // Starts with the corners at the level of the home leaf. If a finer leaf is found, starts again at that leaf's level.
    unsigned level = std::min(natural, home.level());
    for (bool again = true; again;) {
        const unsigned crossed = crossed_axes(box, level);
        unsigned finest = level;
        unsigned corner = 0;
        count = 0;
        do {
            const Directory::Leaf leaf = corner == 0 ? home : directory.leaf(corner_of(box, corner));
            finest = std::max(finest, std::min(natural, leaf.level()));
            corners[count++] = {corner, directory.at_most(leaf, natural)};
            corner = (corner - crossed) & crossed;  // the next subset of `crossed`
        } while (corner != 0);
        again = finest != level;
        level = finest;
    }
    for (const auto& [corner, octant] : std::span(corners).first(count)) {
        const unsigned begins = class_bits(box, directory.octants()[octant]);
        if ((corner & ~begins) == 0) place(octant, begins);
    }
}

}  // namespace octopair
