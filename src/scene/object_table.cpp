#include "scene/object_table.hpp"

#include <algorithm>

namespace octopair {

ObjectTable::ObjectTable(Precision precision) : precision_(precision) {}

Objects ObjectTable::objects() const {
    if (precision_ == Precision::float64) return {boxes64_.span(), paddings_.span()};
    return {boxes32_.span(), paddings_.span()};
}

std::uint32_t ObjectTable::new_index() {
    if (!free_.empty()) {
        const std::uint32_t index = free_.back();
        free_.pop_back();
        return index;
    }
    precision_ == Precision::float64 ? boxes64_.push_back({}) : boxes32_.push_back({});
    slots_.push_back({0, none});
    if (padded_) paddings_.push_back(0);
    if (with_traits_) traits_.push_back({});
    return std::uint32_t(slots_.size() - 1);
}

void ObjectTable::set_box(std::uint32_t index, const Box3d& box) {
    if (precision_ == Precision::float64) {
        boxes64_[index] = box;
        return;
    }
    for (int axis = 0; axis < 3; ++axis) {
        boxes32_[index].min[axis] = float(box.min[axis]);
        boxes32_[index].max[axis] = float(box.max[axis]);
    }
}

void ObjectTable::reserve(std::uint64_t more, bool with_padding, bool with_traits) {
    const std::uint64_t fresh = more - std::min<std::uint64_t>(more, free_.size());
    const std::size_t all = std::size_t(slots_.size() + fresh);
    precision_ == Precision::float64 ? boxes64_.reserve(all) : boxes32_.reserve(all);
    slots_.reserve(all);
    padded_ |= with_padding;
    with_traits_ |= with_traits;
    if (padded_) paddings_.reserve(all);
    if (with_traits_) traits_.reserve(all);
    if (padded_) paddings_.resize(slots_.size(), 0);
    if (with_traits_) traits_.resize(slots_.size(), {});
}

}  // namespace octopair
