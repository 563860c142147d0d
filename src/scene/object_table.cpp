#include "scene/object_table.hpp"

#include <algorithm>
#include <limits>

namespace octopair {

namespace {

template <typename Real>
bool is_within(const Box<Real>& inner, const Box<Real>& outer) {
    bool within = true;
    for (int axis = 0; axis < 3; ++axis) {
        within &= outer.min[axis] <= inner.min[axis] && inner.max[axis] <= outer.max[axis];
    }
    return within;
}

}  // namespace

std::uint32_t ObjectTable::new_index() {
    if (!free_.empty()) {
        const std::uint32_t index = free_.back();
        free_.pop_back();
        return index;
    }
    for (BoxArray* const boxes : {&searched_, &own_}) {
        if (boxes == &own_ && !has_slack()) continue;
        precision_ == Precision::float64 ? boxes->float64.push_back({}) : boxes->float32.push_back({});
    }
    slots_.push_back({0, none});
    if (padded_) paddings_.push_back(0);
    if (with_traits_) traits_.push_back({});
    return std::uint32_t(slots_.size() - 1);
}

void ObjectTable::BoxArray::set(std::uint32_t index, const Box3d& box) {
    if (!float64.empty()) {
        float64[index] = box;
        return;
    }
    for (int axis = 0; axis < 3; ++axis) {
        float32[index].min[axis] = float(box.min[axis]);
        float32[index].max[axis] = float(box.max[axis]);
    }
}

void ObjectTable::find_outside(std::vector<std::uint32_t>& outside) const {
    outside.clear();
    const auto find = [&](const auto& own, const auto& searched) {
        for (std::uint32_t index = 0; index < slots_.size(); ++index) {
            if (!is_within(own[index], searched[index]) && alive(index)) outside.push_back(index);
        }
    };
    precision_ == Precision::float64 ? find(own_.float64, searched_.float64) : find(own_.float32, searched_.float32);
}

template <typename Real>
Box<Real> ObjectTable::enlarged(const Box<Real>& box) const {
    constexpr Real most = std::numeric_limits<Real>::max();
    const auto slack = Real(std::min(slack_, double(most)));
    Box<Real> large;
    // Rounding is monotone, so the enlarged box contains the box.
    for (int axis = 0; axis < 3; ++axis) {
        large.min[axis] = std::max(box.min[axis] - slack, -most);
        large.max[axis] = std::min(box.max[axis] + slack, most);
    }
    return large;
}

void ObjectTable::enlarge(std::uint32_t index) {
    if (precision_ == Precision::float64) {
        searched_.float64[index] = enlarged(own_.float64[index]);
    } else {
        searched_.float32[index] = enlarged(own_.float32[index]);
    }
}

void ObjectTable::enlarge_all() {
    for (std::uint32_t index = 0; index < slots_.size(); ++index) enlarge(index);
}

void ObjectTable::reserve(std::uint64_t more, bool with_padding, bool with_traits) {
    const std::uint64_t fresh = more - std::min<std::uint64_t>(more, free_.size());
    const std::size_t all = std::size_t(slots_.size() + fresh);
    for (BoxArray* const boxes : {&searched_, &own_}) {
        if (boxes == &own_ && !has_slack()) continue;
        precision_ == Precision::float64 ? boxes->float64.reserve(all) : boxes->float32.reserve(all);
    }
    slots_.reserve(all);
    const bool padded = padded_ || with_padding, has_traits = with_traits_ || with_traits;
    if (padded) paddings_.reserve(all);
    if (has_traits) traits_.reserve(all);
    // The following statements cannot fail, so the table is either unchanged or complete.
    padded_ = padded;
    with_traits_ = has_traits;
    if (padded_) paddings_.resize(slots_.size(), 0);
    if (with_traits_) traits_.resize(slots_.size(), {});
}

}  // namespace octopair
