#include "scene/object_table.hpp"

#include <algorithm>

namespace octopair {

ObjectTable::ObjectTable(Precision precision) : precision_(precision) {}

Objects ObjectTable::objects() const {
    if (precision_ == Precision::float64) return {boxes64_.span(), paddings_.span()};
    return {boxes32_.span(), paddings_.span()};
}

ObjectId ObjectTable::create(const Box3d& box, double padding, const Traits& traits) {
    std::uint32_t index = std::uint32_t(slots_.size());
    if (!free_.empty()) {
        index = free_.back();
        free_.pop_back();
    } else {
        reserve(1);
        precision_ == Precision::float64 ? boxes64_.push_back({}) : boxes32_.push_back({});
        slots_.push_back({0, none});
        if (!paddings_.empty()) paddings_.push_back(0);
        if (!traits_.empty()) traits_.push_back({});
    }
    ++slots_[index].generation;
    ++size_;
    set_box(index, box);
    if (padding > 0 && paddings_.empty()) paddings_.resize(slots_.size(), 0);
    if (!paddings_.empty()) paddings_[index] = padding;
    set_traits(index, traits);
    return id(index);
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

void ObjectTable::set_traits(std::uint32_t index, const Traits& traits) {
    if (traits_.empty()) {
        if (traits == Traits{}) return;
        traits_.resize(slots_.size(), {});
    }
    traits_[index] = traits;
}

void ObjectTable::reserve(std::uint64_t more) {
    const std::uint64_t fresh = more - std::min<std::uint64_t>(more, free_.size());
    const std::size_t all = std::size_t(slots_.size() + fresh);
    precision_ == Precision::float64 ? boxes64_.reserve(all) : boxes32_.reserve(all);
    slots_.reserve(all);
    if (!paddings_.empty()) paddings_.reserve(all);
    if (!traits_.empty()) traits_.reserve(all);
}

}  // namespace octopair
