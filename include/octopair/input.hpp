// Input: the objects of a call: one set, or two.
//
// Result    With one set, a call finds the pairs within the set. With two sets, each pair has one object of each set.
// Ownership An input owns what its sets own. Objects are borrowed (objects.hpp); JobObjects are owned or borrowed (job.hpp).
#pragma once

#include <concepts>
#include <optional>
#include <span>
#include <utility>

#include "octopair/objects.hpp"

namespace [[gnu::visibility("default")]] octopair {

/// Two sets of objects. In the pairs of a call, `a` is in the first set and `b` in the second.
template <typename Set>
struct JoinOf {
    Set first;
    Set second;
};

/// One set, or the two sets of a join. Both convert implicitly.
template <typename Set>
struct InputOf {
    // NOLINTBEGIN(google-explicit-constructor): a set converts to an input, and so does a join.
    template <typename Source>
        requires std::convertible_to<Source, Set>
    InputOf(Source set) : first(std::move(set)) {}
    InputOf(JoinOf<Set> join) : first(std::move(join.first)), second(std::move(join.second)) {}
    /// Makes one set of boxes, with or without paddings: find_pairs({boxes, padding}, pairs).
    InputOf(Boxes boxes, std::span<const double> padding = {})
        requires std::same_as<Set, Objects>
        : first{boxes, padding} {}
    // NOLINTEND(google-explicit-constructor)
    /// Makes one set if `other` is empty, else a join.
    InputOf(Set set, std::optional<Set> other) : first(std::move(set)), second(std::move(other)) {}

    Set first;
    std::optional<Set> second;  ///< empty: pairs within the first set
};

using Join = JoinOf<Objects>;
using Input = InputOf<Objects>;

}  // namespace octopair
