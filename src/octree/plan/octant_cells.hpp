// OctantCells: the map from coordinates to the cells of one octant.
//
// Invariants
//   The map is monotone, and the same for all entries of the octant. So if one cell is less than another, the same holds for the
//   coordinates.
//   Coordinates before or behind the octant get its first or last cell.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "boxes/entry.hpp"
#include "octree/plan/directory.hpp"
#include "octree/plan/space.hpp"

namespace octopair {

/// Map from coordinates to the cells of one octant. The first axis is the long axis of the space.
/// Specification of cell_entries() (cell_sweep.hpp) and of BatchEncoder (octree/build/encoder.hpp).
struct OctantCells {
    /// Up to this level an octant has as many fine cells as cells, or more. Deeper octants map coordinates from an origin of
    /// their own: float32 numbers near each other have more digits relative to this origin.
    static constexpr unsigned max_fine_level = SpaceMap::bits - cell_bits;

    SpaceMap map;
    std::array<std::uint32_t, 4> first = {0, 0, 0, 0};  ///< by coordinate axis: first fine cell
    std::uint32_t last_offset = 0;                      ///< number of fine cells on an axis, minus 1
    unsigned level = 0;
    std::array<unsigned, 3> axes = {0, 1, 2};    ///< coordinate axis of each axis of the sweep
    std::array<float, 4> origin = {0, 0, 0, 0};  ///< by coordinate axis: where a deep octant begins
    std::array<float, 4> scale = {1, 1, 1, 0};   ///< cells of a deep octant for each unit of length

    OctantCells() = default;
    OctantCells(const Space& space, const Octant& octant)
        : map(space.map()), last_offset(SpaceMap::last_fine_cell >> octant.level), level(octant.level) {
        for (unsigned axis = 0; axis < 3; ++axis) first[axis] = octant.lo[axis] << SpaceMap::fine_bits;
        for (unsigned k = 0; k < 3; ++k) axes[k] = (space.long_axis() + k) % 3;
        if (!is_deep()) return;
        origin = deep_origin(map, octant);
        for (unsigned axis = 0; axis < 3; ++axis) scale[axis] = map.scale[axis] * deep_factor(level);
    }
    bool is_deep() const { return level > max_fine_level; }

    static std::array<float, 4> deep_origin(const SpaceMap& map, const Octant& octant) {
        std::array<float, 4> origin = {0, 0, 0, 0};
        for (unsigned axis = 0; axis < 3; ++axis) {
            const double begin =
                double(octant.lo[axis] << SpaceMap::fine_bits) - 0.5;  // the map rounds to the nearest cell
            origin[axis] = float(double(map.origin[axis]) + begin / double(map.scale[axis]));
        }
        return origin;
    }
    /// Returns the number of cells for each fine cell, a power of two.
    static float deep_factor(unsigned level) { return std::bit_cast<float>((127 + level - max_fine_level) << 23); }

    std::uint32_t cell(float coordinate, unsigned axis) const {
        if (is_deep()) {
            const float in_octant = (coordinate - origin[axis]) * scale[axis];
            const float below = in_octant > 0.0f ? in_octant : 0.0f;
            const float clamped = below < float(last_octant_cell) ? below : float(last_octant_cell);
            return std::bit_cast<std::uint32_t>(clamped + SpaceMap::whole) & last_octant_cell;
        }
        const std::uint32_t fine_cell = map.fine_cell(coordinate, axis);
        const std::uint32_t clamped = std::clamp(fine_cell, first[axis], first[axis] + last_offset);
        return (clamped << level & SpaceMap::last_fine_cell) >> max_fine_level;
    }
    CellEntry entry(const Entry& entry) const {
        CellEntry cells;
        for (unsigned k = 0; k < 3; ++k) {
            const unsigned axis = axes[k];
            const std::uint32_t low = cell(entry.min[axis], axis), high = cell(entry.max[axis], axis);
            cells.ends[k] = low | high << 16 | flags_of(entry.mask, k);
        }
        cells.object = entry.object;
        return cells;
    }
    /// Returns the flags of ends[k] for a mask of boxes/entry.hpp.
    std::uint32_t flags_of(std::uint32_t mask, unsigned k) const {
        return (mask >> axes[k] & 1u) << CellEntry::class_shift | (mask >> (3 + k) & 1u) << CellEntry::set_shift;
    }
    /// Returns the mask that the flags of an entry stand for.
    std::uint32_t mask_of(const CellEntry& entry) const {
        std::uint32_t mask = 0;
        for (unsigned k = 0; k < 3; ++k) {
            mask |= (entry.ends[k] >> CellEntry::class_shift & 1u) << axes[k];
            mask |= entry.ends[k] >> CellEntry::set_shift << (3 + k);
        }
        return mask;
    }
};

}  // namespace octopair
