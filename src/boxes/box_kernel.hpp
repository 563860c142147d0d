// Tests of the caller's boxes: which are valid, and which overlap. Many boxes are tested at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <variant>

#include "boxes/box_check.hpp"
#include "boxes/entry.hpp"
#include "boxes/entry_source.hpp"
#include "octopair/objects.hpp"

namespace octopair {

template <typename Real>
Box3d wide(const Box<Real>& box) {
    return {{double(box.min[0]), double(box.min[1]), double(box.min[2])},
            {double(box.max[0]), double(box.max[1]), double(box.max[2])}};
}

/// Returns a box of a set in float64.
inline Box3d wide_box(const Objects& set, std::size_t index) {
    return std::visit([&](auto boxes) { return wide(boxes[index]); }, set.boxes);
}

/// True if the closed boxes overlap.
template <typename Real>
bool overlap(const Box<Real>& a, const Box<Real>& b) {
    bool all = true;
    for (int axis = 0; axis < 3; ++axis) all &= a.min[axis] <= b.max[axis] && b.min[axis] <= a.max[axis];
    return all;
}

/// True if all boxes are valid (is_box()).
bool are_boxes(std::span<const Box3f> boxes);
bool are_boxes(std::span<const Box3d> boxes);

/// Copies the bounds of boxes unchanged. Returns false if is_box() is false for any box.
bool copy_boxes(std::span<const Box3f> boxes, std::span<Entry> out);

/// The boxes of the objects `a` and `b` of pairs. The first object `b` has the number `second_begin`.
template <typename Real>
struct BoxesOfPairs {
    const Box<Real>* first;
    const Box<Real>* second;
    std::uint32_t second_begin;

    const Box<Real>& a(const Pair& pair) const { return first[pair.a]; }
    const Box<Real>& b(const Pair& pair) const { return second[pair.b - second_begin]; }
};

/// Implements EntrySource::refused() for boxes that are a pair if they overlap.
std::size_t refused_pairs(const DoubtfulPairs& doubtful, const BoxesOfPairs<float>& boxes, std::uint32_t* out);
std::size_t refused_pairs(const DoubtfulPairs& doubtful, const BoxesOfPairs<double>& boxes, std::uint32_t* out);

}  // namespace octopair
