// Space: the choice of a space for a sample, and the SIMD version of Space::cells, which has one end of a box in each register.
// Highway compiles the SIMD version for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "octree/plan/space.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "base/tuning.hpp"
#include "octree/plan/space.hpp"

HWY_BEFORE_NAMESPACE();
namespace octopair {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

template <typename Bounds>
void cells_simd(const SpaceMap& map, std::span<const Bounds> bounds, std::span<CellBox> boxes) {
    for (std::size_t i = 0; i < bounds.size(); ++i) {
        for (unsigned axis = 0; axis < 3; ++axis) {
            boxes[i].lo[axis] = map.cell(bounds[i].min[axis], axis);
            boxes[i].hi[axis] = std::max(boxes[i].lo[axis], map.cell(bounds[i].max[axis], axis));
        }
    }
}

#else

/// Returns both ends of a box: x, y, z, and a fourth number that is ignored.
template <typename D, typename Bounds>
auto load_ends(D d, const Bounds& bounds) {
    const float* const numbers = bounds.min;
    const auto low = hn::LoadU(d, numbers);
    if constexpr (sizeof(Bounds) == 6 * sizeof(float)) {  // does not read beyond the end of the box
        return std::pair(low, hn::Shuffle0321(hn::LoadU(d, numbers + 2)));
    } else {
        return std::pair(low, hn::LoadU(d, numbers + 3));
    }
}

template <typename Bounds>
void cells_simd(const SpaceMap& map, std::span<const Bounds> bounds, std::span<CellBox> boxes) {
    const hn::FixedTag<float, 4> floats;
    const hn::FixedTag<std::uint32_t, 4> words;
    constexpr std::uint32_t digits = SpaceMap::last_fine_cell;
    alignas(16) constexpr std::array<std::uint32_t, 4> xyz = {digits, digits, digits, 0};
    const auto kept = hn::Load(words, xyz.data());
    const auto origin = hn::LoadU(floats, map.origin.data());
    const auto scale = hn::LoadU(floats, map.scale.data());
    const auto last = hn::LoadU(floats, map.last.data());
    const auto whole = hn::Set(floats, SpaceMap::whole);
    const auto cell = [&](auto coordinates) HWY_ATTR {
        const auto scaled = hn::Mul(hn::Sub(coordinates, origin), scale);
        const auto clamped = hn::Min(hn::Max(scaled, hn::Zero(floats)), last);
        return hn::ShiftRight<SpaceMap::fine_bits>(hn::And(hn::BitCast(words, hn::Add(clamped, whole)), kept));
    };
    for (std::size_t i = 0; i < bounds.size(); ++i) {
        // Reads both ends before it writes one. Otherwise a read may wait for a write to an address 4 KiB away (4K aliasing).
        const auto [low, high] = load_ends(floats, bounds[i]);
        const auto lo = cell(low);
        hn::Store(lo, words, boxes[i].lo.data());
        hn::Store(hn::Max(lo, cell(high)), words, boxes[i].hi.data());
    }
}

#endif

void cells_of_entries(const SpaceMap& map, std::span<const Entry> entries, std::span<CellBox> boxes) {
    cells_simd(map, entries, boxes);
}

void cells_of_boxes(const SpaceMap& map, std::span<const Box3f> bounds, std::span<CellBox> boxes) {
    cells_simd(map, bounds, boxes);
}

}  // namespace HWY_NAMESPACE
}  // namespace octopair
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace octopair {

namespace {

/// Range of the bulk of the objects on one axis, and the extent of a typical object.
struct AxisFit {
    double begin = 0, end = 0, typical = 0;
    double extent() const { return end - begin; }
};

/// Returns the range between the 1/64 quantiles, plus a quarter on each side, but within the range of the sample.
AxisFit fit_axis(std::span<const SpaceSample::Measured, SpaceSample::measures> measured) {
    const SpaceSample::Measured &lows = measured[0], &highs = measured[1], &extents = measured[2];
    const double quarter = std::max(0.0, highs.quantile - lows.quantile) / 4;
    AxisFit fit;
    fit.begin = std::max(lows.extreme, lows.quantile - quarter);
    fit.end = std::max(fit.begin, std::min(highs.extreme, highs.quantile + quarter));
    fit.typical = std::max(0.0, extents.quantile);
    return fit;
}

}  // namespace

SpaceSample::SpaceSample(std::size_t sampled) : stride_(sampled / tuning().sampling.space_objects + 1) {}

SpaceSample::Measured SpaceSample::measure(std::span<const Interval> intervals, Measure what) {
    std::vector<double> values;
    values.reserve(intervals.size());
    for (const Interval& interval : intervals) {
        const double low = double(interval.low), high = double(interval.high);
        if (!(std::abs(low) <= double(FLT_MAX) && std::abs(high) <= double(FLT_MAX))) continue;  // refused later
        values.push_back(what == Measure::low ? low : what == Measure::high ? high : high - low);
    }
    if (values.empty()) return {};
    if (what == Measure::extent) {
        const auto median = values.begin() + std::ptrdiff_t(values.size() / 2);
        std::nth_element(values.begin(), median, values.end());
        return {*median, *std::max_element(median, values.end())};
    }
    // Only 1/64 of the values is beyond the quantile. Sorting these values alone takes less time than partitioning all values.
    const auto quantile = values.begin() + std::ptrdiff_t(values.size() / 64);
    if (what == Measure::low) {
        std::partial_sort(values.begin(), quantile + 1, values.end());
    } else {
        std::partial_sort(values.begin(), quantile + 1, values.end(), std::greater<>());
    }
    return {*quantile, values.front()};
}

namespace {

/// Returns an estimate of the distance between neighbouring objects: a power of two near the cube root of volume / objects. Ignores axes
/// without extent: with two axes, it is the square root of area / objects.
double spacing(const std::array<AxisFit, 3>& axes, std::uint64_t objects) {
    int exponent = -int(std::bit_width(objects));
    int dimensions = 0;
    for (const AxisFit& axis : axes) {
        if (axis.extent() <= 0) continue;
        int own = 0;
        (void)std::frexp(axis.extent(), &own);
        exponent += own;
        ++dimensions;
    }
    return dimensions == 0 ? 1.0 : std::ldexp(1.0, exponent / dimensions);
}

}  // namespace

Space Space::fit(std::span<const Entry> sample, std::uint64_t objects) {
    const SpaceSample chosen(sample.size());
    SpaceSample::AllMeasured measured;
    std::vector<SpaceSample::Interval> intervals;
    for (unsigned axis = 0; axis < 3; ++axis) {
        intervals.clear();
        for (std::size_t i = 0; i < sample.size(); ++i) {
            if (chosen.has(i)) intervals.push_back({sample[i].min[axis], sample[i].max[axis]});
        }
        for (unsigned what = 0; what < SpaceSample::measures; ++what) {
            measured[axis * SpaceSample::measures + what] = SpaceSample::measure(intervals, SpaceSample::Measure(what));
        }
    }
    return fit(measured, objects);
}

Space Space::fit(const SpaceSample::AllMeasured& measured, std::uint64_t objects) {
    std::array<AxisFit, 3> axes;
    for (unsigned axis = 0; axis < 3; ++axis) {
        axes[axis] = fit_axis(std::span(measured).subspan(axis * SpaceSample::measures).first<SpaceSample::measures>());
    }
    const double neighbour = spacing(axes, objects);

    // An octant has the shape of one object with the free space around it.
    std::array<double, 3> shape{};
    double max_octants = 0;
    Space space;
    for (unsigned axis = 0; axis < 3; ++axis) {
        shape[axis] = neighbour + axes[axis].typical;
        const double octants = axes[axis].extent() / shape[axis];
        if (octants > max_octants) {
            max_octants = octants;
            space.long_axis_ = axis;
        }
    }
    shape[space.long_axis_] *= 4;
    for (unsigned axis = 0; axis < 3; ++axis) {
        const double length = shape[axis] * max_octants;
        const double scale = length > 0 ? double(SpaceMap::last_fine_cell + 1) / length : 1.0;
        space.map_.origin[axis] = float(axes[axis].begin);
        space.map_.scale[axis] = float(std::clamp(scale, double(FLT_MIN), double(FLT_MAX)));
        constexpr std::uint32_t last_in_cell = (1u << SpaceMap::fine_bits) - 1;
        space.map_.last[axis] = float(space.map_.fine_cell(float(axes[axis].end), axis) | last_in_cell);
    }
    return space;
}

HWY_EXPORT(cells_of_entries);
HWY_EXPORT(cells_of_boxes);

void Space::cells(std::span<const Entry> entries, std::span<CellBox> boxes) const {
    HWY_DYNAMIC_DISPATCH(cells_of_entries)(map_, entries, boxes);
}

void Space::cells(std::span<const Box3f> bounds, std::span<CellBox> boxes) const {
    HWY_DYNAMIC_DISPATCH(cells_of_boxes)(map_, bounds, boxes);
}

}  // namespace octopair

#endif  // HWY_ONCE
