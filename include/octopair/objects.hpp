// Objects and pairs: the plain data of every call.
//
// Units     lengths are the caller's own; `margin` and `padding` are in the same unit. Objects are positions in a span.
// Rule      a pair counts when on every axis max(a.min - b.max, b.min - a.max) <= margin + (padding_a + padding_b), each
//           operation in float64; without margin and padding: when the closed boxes overlap, touching included.
// State     the caller's floating-point state (rounding, subnormal numbers taken for 0, traps) changes no result. Calls set
//           the default state and restore the caller's at the end; sinks, progress and filters are called in the default.
// Ownership boxes and padding are borrowed and never modified.
#pragma once

#include <compare>
#include <cstdint>
#include <span>
#include <variant>

namespace octopair {

/// A closed axis-aligned box: a row of an (n, 6) array. min[i] <= max[i], all finite.
template <typename Real>
struct Box {
    Real min[3];
    Real max[3];
};
using Box3f = Box<float>;
using Box3d = Box<double>;

/// Boxes of either precision, borrowed.
using Boxes = std::variant<std::span<const Box3f>, std::span<const Box3d>>;

/// The objects of a call, borrowed: the arrays must outlive it. At most 2^32 - 1 objects (in a join, both sets
/// together).
struct Objects {
    Boxes boxes;
    std::span<const double> padding = {};  ///< empty, or one clearance per object; finite, >= 0

    std::uint64_t size() const noexcept {
        return std::visit([](auto span) -> std::uint64_t { return span.size(); }, boxes);
    }
};

/// Two objects by their positions in the input; a < b (in a join: a of the first set, b of the second).
struct Pair {
    std::uint32_t a, b;
    auto operator<=>(const Pair&) const = default;
};

}  // namespace octopair
