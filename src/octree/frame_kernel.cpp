// Frame::cells for many boxes: one box end to a register, compiled for each instruction set by Highway.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "octree/frame_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "octree/frame.hpp"

HWY_BEFORE_NAMESPACE();
namespace octopair {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

void cells_simd(const FrameMap& map, std::span<const Entry> entries, std::span<CellBox> boxes) {
    for (std::size_t i = 0; i < entries.size(); ++i) {
        for (unsigned axis = 0; axis < 3; ++axis) {
            boxes[i].lo[axis] = map.cell(entries[i].min[axis], axis);
            boxes[i].hi[axis] = map.cell(entries[i].max[axis], axis);
        }
    }
}

#else

void cells_simd(const FrameMap& map, std::span<const Entry> entries, std::span<CellBox> boxes) {
    const hn::FixedTag<float, 4> floats;
    const hn::FixedTag<std::uint32_t, 4> words;
    const hn::FixedTag<std::int32_t, 4> integers;
    alignas(16) constexpr std::array<std::uint32_t, 4> xyz = {~0u, ~0u, ~0u, 0};  // what shares the register is cleared
    const auto kept = hn::Load(words, xyz.data());
    const auto origin = hn::LoadU(floats, map.origin.data());
    const auto scale = hn::LoadU(floats, map.scale.data());
    const auto last = hn::LoadU(floats, map.last.data());
    const auto cell = [&](auto coordinates) HWY_ATTR {
        const auto scaled = hn::Mul(hn::Sub(coordinates, origin), scale);
        const auto clamped = hn::Min(hn::Max(scaled, hn::Zero(floats)), last);
        return hn::And(hn::BitCast(words, hn::ConvertTo(integers, clamped)), kept);
    };
    for (std::size_t i = 0; i < entries.size(); ++i) {
        // Both are read before one is written: the processor mistakes addresses 4 KiB apart for the same.
        const auto low = hn::LoadU(floats, entries[i].min);
        const auto high = hn::LoadU(floats, entries[i].max);
        hn::Store(cell(low), words, boxes[i].lo.data());
        hn::Store(cell(high), words, boxes[i].hi.data());
    }
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace octopair
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace octopair {

HWY_EXPORT(cells_simd);

void Frame::cells(std::span<const Entry> entries, std::span<CellBox> boxes) const {
    HWY_DYNAMIC_DISPATCH(cells_simd)(map_, entries, boxes);
}

}  // namespace octopair

#endif  // HWY_ONCE
