#include "octree/dynamic/leaf_grid.hpp"

#include <algorithm>
#include <bit>

#include "base/tuning.hpp"

namespace octopair {

SmallBox Unit::small(const CellBox& box) const {
    std::array<float, 4> low, high;  // the last number is unused
    for (unsigned axis = 0; axis < 4; ++axis) {
        const auto number = [&](std::uint32_t cell) {
            return float(std::int32_t(cell - lo[axis])) * scale[axis] + 1.0f;
        };
        const float begin = number(box.lo[axis]), end = number(box.hi[axis]);
        low[axis] = begin > 0.0f ? begin : 0.0f;
        high[axis] = std::min(end, float(last_number + 1));
    }
    SmallBox small;
    for (unsigned axis = 0; axis < 3; ++axis) {
        small.set(axis, std::uint32_t(std::int32_t(low[axis])), std::uint32_t(std::int32_t(high[axis])));
    }
    return small;
}

/// Returns the scale (numbers of a SmallBox for each cell) of a unit that has 2^side cells of the space on an axis.
float LeafGrid::scale_of(unsigned side) {
    constexpr unsigned exponent_zero = 127, fraction_bits = 23;
    return float(Unit::last_number) * std::bit_cast<float>((exponent_zero - side) << fraction_bits);
}

/// Halves the cells of the grid repeatedly, each time on the axis on which cells are longest in units of the mean box extent. Stops when
/// a cell is expected to hold few boxes, or when a further cut would multiply the entries.
LeafGrid LeafGrid::cut(const Octant& octant, std::uint32_t begin, std::span<const CellBox> boxes) {
    LeafGrid grid{
        {octant.lo[0], octant.lo[1], octant.lo[2]}, begin, std::uint8_t(octant.level), {}, !octant.leaf(), false};
    if (grid.inner) return grid;
    std::array<double, 3> extents{1, 1, 1}, sides;
    for (const CellBox& box : boxes) {
        for (unsigned axis = 0; axis < 3; ++axis) {
            const std::uint32_t first = std::max(box.lo[axis], grid.lo[axis]);
            extents[axis] += double(std::min(box.hi[axis], grid.last(axis)) - first);
        }
    }
    for (unsigned axis = 0; axis < 3; ++axis) {
        extents[axis] /= double(boxes.size() + 1);
        sides[axis] = double(cells_per_axis >> octant.level);
    }
    double objects = double(boxes.size());
    for (unsigned bits = 0; bits < tuning().dynamic.max_grid_bits && objects > tuning().dynamic.max_cell_objects;
         ++bits) {
        unsigned longest = 0;
        for (unsigned axis = 1; axis < 3; ++axis) {
            if (sides[axis] * extents[longest] > sides[longest] * extents[axis]) longest = axis;
        }
        sides[longest] /= 2;
        double growth = 1;
        for (unsigned axis = 0; axis < 3; ++axis) growth *= 1 + extents[axis] / sides[axis];
        if (growth > tuning().dynamic.max_growth || sides[longest] < 1) break;
        ++grid.bits[longest];
        objects /= 2;
    }
    return grid;
}

CellRegion LeafGrid::region() const { return region(all()); }

CellRegion LeafGrid::region(const GridRange& range) const {
    CellRegion region;
    for (unsigned axis = 0; axis < 3; ++axis) {
        region.lo[axis] = lo[axis] + (range.first[axis] << side(axis));
        region.hi[axis] = lo[axis] + ((range.last[axis] + 1) << side(axis));
    }
    return region;
}

Unit LeafGrid::own_unit() const {
    const float scale = scale_of(deepest - level);
    return {{lo[0], lo[1], lo[2], 0}, {scale, scale, scale, 0}, begin};
}

GridRange LeafGrid::all() const { return {{0, 0, 0}, {(1u << bits[0]) - 1, (1u << bits[1]) - 1, (1u << bits[2]) - 1}}; }

GridRange LeafGrid::range_of(const CellBox& box) const {
    GridRange range;
    for (unsigned axis = 0; axis < 3; ++axis) {
        range.first[axis] = (std::max(box.lo[axis], lo[axis]) - lo[axis]) >> side(axis);
        range.last[axis] = (std::min(box.hi[axis], last(axis)) - lo[axis]) >> side(axis);
    }
    return range;
}

}  // namespace octopair
