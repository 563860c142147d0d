// Overlap test of two closed boxes, and output of pairs. Internal to the baselines.
#pragma once

#include <cstdint>

#include "octopair/objects.hpp"

namespace octopair::baselines {

template <typename Real>
constexpr bool overlap(const Box<Real>& a, const Box<Real>& b) {
    return a.min[0] <= b.max[0] && b.min[0] <= a.max[0] && a.min[1] <= b.max[1] && b.min[1] <= a.max[1] &&
           a.min[2] <= b.max[2] && b.min[2] <= a.max[2];
}

constexpr Pair ordered(std::uint32_t i, std::uint32_t j) { return i < j ? Pair{i, j} : Pair{j, i}; }

}  // namespace octopair::baselines
