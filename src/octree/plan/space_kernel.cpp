// SIMD version of Space::cells: one end of a box in each register. Highway compiles it for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "octree/plan/space_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <utility>

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
