// Objects and pairs: the plain data of every call.
//
// Units     All lengths, margin and padding included, are in the caller's unit.
// Objects   An object is identified by its index in the span of boxes.
// Rule      A pair counts if on every axis max(a.min - b.max, b.min - a.max) <= margin + (padding_a + padding_b), each
//           operation in float64. Without margin and padding: if the closed boxes overlap, touching included.
// State     The caller's floating-point state (rounding mode, flushing of subnormal numbers, traps) changes no result. A call
//           sets the default state and restores the caller's state at its end. Sinks, progress functions and filters run in
//           the default state.
// Ownership Boxes and padding are borrowed and never modified. If they change during a call, its result is arbitrary, or an error.
#pragma once

#include <compare>
#include <cstdint>
#include <span>
#include <variant>

namespace [[gnu::visibility("default")]] octopair {

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

/// Objects of one call. Borrowed: the arrays must outlive the call. At most 2^32 - 1 objects (in a join, both sets together).
struct Objects {
    Boxes boxes;
    std::span<const double> padding = {};  ///< clearance of each object, finite and >= 0; empty: no padding

    std::uint64_t size() const noexcept {
        return std::visit([](auto span) -> std::uint64_t { return span.size(); }, boxes);
    }
};

/// Indices of two objects; a < b (in a join: a is in the first set, b in the second).
struct Pair {
    std::uint32_t a, b;
    auto operator<=>(const Pair&) const = default;
};

}  // namespace octopair
