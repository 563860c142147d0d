// Space: the octree's space, and the one monotone map from coordinates to its cells.
//
// Each axis has 2^21 cells (the deepest level of an octal code). cell() never falls as the coordinate grows, and is
// used for everything: which octant a box begins in, which octants it touches, and which octant reports a pair. So
// rounding at octant borders can neither lose nor duplicate a pair, and what lies outside the space is clamped into its
// border cells.
//
// fit() chooses the space from a sample: bounds of the bulk (a far-out object does not stretch them), octants longer on
// axes on which objects are longer, and four times longer on the axis that separates the objects best, along which
// octants are swept. It uses no library function whose last bit could differ between machines.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>

#include "boxes/entry.hpp"
#include "octopair/objects.hpp"
#include "octopair/octal_code.hpp"

namespace octopair {

/// A cell on each axis, and a zero that makes it a register.
using Cell = std::array<std::uint32_t, 4>;

inline constexpr unsigned deepest = OctalCode::max_level;
inline constexpr std::uint32_t cells_per_axis = std::uint32_t(1) << deepest;

/// The cells that a box touches on each axis, both ends included.
struct alignas(16) CellBox {
    Cell lo = {}, hi = {};
};

/// The deepest level at which the box touches at most two octants on each axis, so at most eight.
inline unsigned natural_level(const CellBox& box) {
    const std::uint32_t extent = (box.hi[0] - box.lo[0]) | (box.hi[1] - box.lo[1]) | (box.hi[2] - box.lo[2]);
    return deepest - unsigned(std::bit_width(extent));
}

/// The map: the specification of what the kernel does with many boxes at once.
struct SpaceMap {
    static constexpr float end = float(cells_per_axis - 1);
    static constexpr float whole = 0x1p23f;  // from here on numbers are whole: adding it rounds, and shows the digits
    std::array<float, 4> origin = {0, 0, 0, 0};
    std::array<float, 4> scale = {1, 1, 1, 0};
    std::array<float, 4> last = {end, end, end, 0};

    std::uint32_t cell(float coordinate, unsigned axis) const {
        // Clamped before the conversion: infinity (of an overflowing difference) is a border cell like any far value.
        const float scaled = (coordinate - origin[axis]) * scale[axis];
        const float below = scaled > 0.0f ? scaled : 0.0f;
        const float clamped = below < last[axis] ? below : last[axis];
        return std::bit_cast<std::uint32_t>(clamped + whole) & (cells_per_axis - 1);
    }
};

/// What a space is fitted to: some of the sampled boxes, of which three numbers are measured on each axis. The order of
/// boxes does not matter, and each number can be measured in another place.
class SpaceSample {
public:
    /// Of a sample of so many.
    explicit SpaceSample(std::size_t sampled);
    /// Whether the i-th of the sample counts.
    bool has(std::size_t i) const { return i % stride_ == 0; }

    /// A box on one axis.
    struct Interval {
        float low, high;
    };
    enum class Measure : std::uint8_t { low, high, extent };
    static constexpr unsigned measures = 3;
    /// Of the lows: the least, and a quantile near it; likewise the highs; of the extents the median.
    struct Measured {
        double quantile = 0, extreme = 0;
    };
    static Measured measure(std::span<const Interval> intervals, Measure what);
    /// Of all axes, one after another.
    using AllMeasured = std::array<Measured, 3 * measures>;

private:
    std::size_t stride_;
};

class Space {
public:
    Space() = default;
    /// `objects`: how many the sample stands for. The sample may be empty.
    static Space fit(std::span<const Entry> sample, std::uint64_t objects);
    static Space fit(const SpaceSample::AllMeasured& measured, std::uint64_t objects);

    CellBox cells(const Entry& entry) const {
        CellBox box;
        cells(std::span(&entry, 1), {&box, 1});
        return box;
    }
    /// Of many at once (frame_kernel.cpp). Of what is not a valid box, some cells with lo <= hi.
    void cells(std::span<const Entry> entries, std::span<CellBox> boxes) const;
    void cells(std::span<const Box3f> bounds, std::span<CellBox> boxes) const;

    /// At least all coordinates that these cells stand for; infinite at the border.
    Box3d bounds(const CellBox& cells) const;

    const SpaceMap& map() const { return map_; }
    /// The axis that octants are long on and are swept along first.
    unsigned long_axis() const { return long_axis_; }
    /// The last cell of an axis that a box can touch.
    std::uint32_t last_cell(unsigned axis) const { return std::uint32_t(map_.last[axis]); }

private:
    SpaceMap map_;
    unsigned long_axis_ = 0;
};

}  // namespace octopair
