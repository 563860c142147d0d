// SIMD version of BoxLocator. Highway compiles it for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "octree/build/box_locator_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "octree/build/box_lanes-inl.hpp"
#include "octree/build/box_locator.hpp"

HWY_BEFORE_NAMESPACE();
namespace octopair {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

bool locate_boxes_simd(const BoxLocator& locator, std::span<const Box3f> boxes, LocatedBatch& batch) {
    return locator.locate_scalar(boxes, batch);
}
void locate_entries_simd(const BoxLocator& locator, std::span<const Entry> entries, LocatedBatch& batch) {
    locator.locate_scalar(entries, batch);
}

#else

template <typename Item>
bool locate_lanes(const BoxLocator& locator, std::span<const Item> items, LocatedBatch& batch) {
    const Words d;
    const Constants constants(locator);
    if (locator.large_table) prefetch_leaves(constants, items);
    batch.crossers = 0;
    LaneReader<Item> reader(items);
    for (std::size_t i = 0; i < items.size(); i += hn::Lanes(d)) {
        const Located at(constants, reader.load(i, 0));
        hn::StoreU(at.leaf, d, batch.leaves.data() + i);
        append_crossers(at, i, reader.live(i), batch);
    }
    for (std::size_t i = 0; i < batch.crossers; i += hn::Lanes(d)) {
        const auto end = [&](unsigned axis) HWY_ATTR { return hn::LoadU(d, batch.high[axis].data() + i); };
        hn::StoreU(constants.leaves(end(0), end(1), end(2)), d, batch.end_leaf.data() + i);
    }
    return reader.all_valid();
}

bool locate_boxes_simd(const BoxLocator& locator, std::span<const Box3f> boxes, LocatedBatch& batch) {
    return locate_lanes(locator, boxes, batch);
}
void locate_entries_simd(const BoxLocator& locator, std::span<const Entry> entries, LocatedBatch& batch) {
    (void)locate_lanes(locator, entries, batch);
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace octopair
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace octopair {

HWY_EXPORT(locate_boxes_simd);
HWY_EXPORT(locate_entries_simd);

bool BoxLocator::locate(std::span<const Box3f> boxes, LocatedBatch& batch) const {
    return HWY_DYNAMIC_DISPATCH(locate_boxes_simd)(*this, boxes, batch);
}

void BoxLocator::locate(std::span<const Entry> entries, LocatedBatch& batch) const {
    HWY_DYNAMIC_DISPATCH(locate_entries_simd)(*this, entries, batch);
}

}  // namespace octopair

#endif  // HWY_ONCE
