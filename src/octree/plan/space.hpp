// Space: the octree's quantised space, and the one monotone map from coordinates to its cells.
//
// Invariants
//   Each axis has 2^21 cells, as the deepest level of an octal code has octants.
//   SpaceMap is monotone: its results never fall as the coordinate grows.
//   The same map decides which octant a box begins in, which octants it touches, and which octant reports a pair. So
//   rounding at octant borders neither loses nor duplicates a pair.
//   Coordinates outside the space are clamped into its border cells.
//
// Space::fit() chooses the space from a sample:
//   The bounds are those of the bulk of the objects; a far-out object does not stretch them.
//   Octants are longer on axes on which objects are longer.
//   Octants are four times longer on the axis that separates the objects best. Octants are swept along this axis.
//   No library function is used whose last bit could differ between machines.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>

#include "base/private_export.hpp"
#include "boxes/entry.hpp"
#include "octopair/objects.hpp"
#include "octopair/octal_code.hpp"

namespace octopair {

/// Number of a cell on each axis, and a zero that fills up a SIMD register.
using Cell = std::array<std::uint32_t, 4>;

inline constexpr unsigned deepest = OctalCode::max_level;
inline constexpr std::uint32_t cells_per_axis = std::uint32_t(1) << deepest;

/// The cells that a box touches on each axis, both ends included.
struct alignas(16) CellBox {
    Cell lo = {}, hi = {};
};

inline constexpr CellBox all_cells = {{}, {cells_per_axis - 1, cells_per_axis - 1, cells_per_axis - 1, 0}};

/// Returns a level at which the box touches at most two octants on each axis, so at most eight. It is the deepest such level, or the
/// level above the deepest.
inline unsigned natural_level(const CellBox& box) {
    const std::uint32_t extent = (box.hi[0] - box.lo[0]) | (box.hi[1] - box.lo[1]) | (box.hi[2] - box.lo[2]);
    return deepest - unsigned(std::bit_width(extent));
}

/// Map from coordinates to cells: the specification of the SIMD versions (space.cpp, octree/build/encoder_kernel.cpp).
struct SpaceMap {
    static constexpr unsigned fine_bits = 2;  ///< a cell has 2^fine_bits fine cells on each axis
    static constexpr unsigned bits = deepest + fine_bits;
    static constexpr std::uint32_t last_fine_cell = (std::uint32_t(1) << bits) - 1;
    static constexpr float whole = 0x1p23f;  // adding 2^23 rounds a number to an integer, which the low bits then hold
    std::array<float, 4> origin = {0, 0, 0, 0};
    std::array<float, 4> scale = {1, 1, 1, 0};  ///< fine cells for each unit of length
    std::array<float, 4> last = {float(last_fine_cell), float(last_fine_cell), float(last_fine_cell), 0};

    std::uint32_t fine_cell(float coordinate, unsigned axis) const {
        // Clamped before the conversion: an overflowing difference (infinity) gets a border cell, like any far value.
        const float scaled = (coordinate - origin[axis]) * scale[axis];
        const float below = scaled > 0.0f ? scaled : 0.0f;
        const float clamped = below < last[axis] ? below : last[axis];
        return std::bit_cast<std::uint32_t>(clamped + whole) & last_fine_cell;
    }
    std::uint32_t cell(float coordinate, unsigned axis) const { return fine_cell(coordinate, axis) >> fine_bits; }
};

/// The subset of the sampled boxes that a space is fitted to, and three measures of this subset on each axis. Measures do not depend on
/// the order of boxes, and several processes can compute one measure each.
class OCTOPAIR_PRIVATE_EXPORT SpaceSample {
public:
    /// `sampled`: number of boxes in the sample.
    explicit SpaceSample(std::size_t sampled);
    /// True if box `i` of the sample belongs to the subset.
    bool has(std::size_t i) const { return i % stride_ == 0; }

    /// The two ends of a box on one axis.
    struct Interval {
        float low, high;
    };
    enum class Measure : std::uint8_t { low, high, extent };
    static constexpr unsigned measures = 3;
    /// `low`: the 1/64 quantile and the minimum. `high`: the 63/64 quantile and the maximum. `extent`: the median and the
    /// maximum.
    struct Measured {
        double quantile = 0, extreme = 0;
    };
    /// Returns zeros if no interval is finite.
    static Measured measure(std::span<const Interval> intervals, Measure what);
    /// All measures of the first axis, then of the second and of the third.
    using AllMeasured = std::array<Measured, 3 * measures>;

private:
    std::size_t stride_;
};

class OCTOPAIR_PRIVATE_EXPORT Space {
public:
    Space() = default;
    /// Returns a space for the `objects` objects that the sample represents. The sample may be empty.
    static Space fit(std::span<const Entry> sample, std::uint64_t objects);
    static Space fit(const SpaceSample::AllMeasured& measured, std::uint64_t objects);

    CellBox cells(const Entry& entry) const {
        CellBox box;
        cells(std::span(&entry, 1), {&box, 1});
        return box;
    }
    /// Computes the cells of many boxes at once. An invalid box gets some cells with lo <= hi.
    void cells(std::span<const Entry> entries, std::span<CellBox> boxes) const;
    void cells(std::span<const Box3f> bounds, std::span<CellBox> boxes) const;

    const SpaceMap& map() const { return map_; }
    /// Returns the axis on which octants are longest. Octants are swept along this axis first.
    unsigned long_axis() const { return long_axis_; }
    /// Returns the last cell of an axis that a box can touch.
    std::uint32_t last_cell(unsigned axis) const { return std::uint32_t(map_.last[axis]) >> SpaceMap::fine_bits; }

private:
    SpaceMap map_;
    unsigned long_axis_ = 0;
};

}  // namespace octopair
