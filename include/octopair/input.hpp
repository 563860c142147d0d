// Input: the objects of a call: one set, or two.
//
// Result    of one set: the pairs within it. Of two sets: the pairs of one object of each; a is in the first set.
// Ownership as that of the sets: Objects are borrowed (objects.hpp), JobObjects are kept or borrowed (job.hpp).
#pragma once

#include <concepts>
#include <optional>
#include <span>
#include <utility>

#include "octopair/objects.hpp"

namespace octopair {

/// Two sets of objects. In the pairs of a call, `a` is in the first set and `b` in the second.
template <typename Set>
struct JoinOf {
    Set first;
    Set second;
};

/// One set, or the two sets of a join. Made implicitly from either.
template <typename Set>
struct InputOf {
    // NOLINTBEGIN(google-explicit-constructor): a set is an input, and so is a join.
    template <typename Source>
        requires std::convertible_to<Source, Set>
    InputOf(Source set) : first(std::move(set)) {}
    InputOf(JoinOf<Set> join) : first(std::move(join.first)), second(std::move(join.second)) {}
    /// Objects by their boxes alone, and with paddings: find_pairs({boxes, padding}, pairs).
    InputOf(Boxes boxes, std::span<const double> padding = {})
        requires std::same_as<Set, Objects>
        : first{boxes, padding} {}
    // NOLINTEND(google-explicit-constructor)
    /// One set if `other` is empty, else a join.
    InputOf(Set set, std::optional<Set> other) : first(std::move(set)), second(std::move(other)) {}

    Set first;
    std::optional<Set> second;  ///< empty: pairs within the first set
};

using Join = JoinOf<Objects>;
using Input = InputOf<Objects>;

}  // namespace octopair
