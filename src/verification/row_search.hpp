// RowSearch: all pairs of a call, object by object, found without the octree.
//
// Result     the pairs that objects.hpp defines, judged in float64 on the caller's numbers. This search and the engines
//            share no code beyond src/base and src/parallel, so that an error of one is not an error of both.
// Row        the pairs (a, b) of one object a. Within one set b > a. In a join, a is a position in the first set and b a
//            position in the second set.
// Memory     float32: 33 bytes an object of the set that is searched (the second one of a join); float64: 64 bytes. The
//            number of pairs does not matter.
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <variant>
#include <vector>

#include "octopair/objects.hpp"
#include "parallel/team.hpp"
#include "verification/box_tree.hpp"

namespace octopair {

/// The objects of a call and the gap up to which a pair counts.
struct SearchedObjects {
    const Objects& first;
    const Objects* second = nullptr;  ///< the other set of a join; null: pairs within `first`
    double margin = 0;
    /// Further condition: (a, b) is a pair only if allows(a, b) is true. Any thread may call it. Empty: no further condition.
    std::function<bool(std::uint32_t a, std::uint32_t b)> allows = {};
};

class RowSearch {
public:
    /// Borrows the boxes and the padding. Requires: a finite margin >= 0, and a valid `first` in a join.
    /// Throws: Error{engine_failed} for an invalid box or padding of the searched set; Error{cancelled}, std::bad_alloc.
    /// Complexity: O(n log n) / threads.
    RowSearch(const SearchedObjects& objects, Team& team, const std::stop_token& stop = {});

    std::uint32_t rows() const { return std::uint32_t(first_.size()); }
    /// Exclusive upper bound of every `b`.
    std::uint32_t columns() const { return std::uint32_t(join_ ? second_.size() : first_.size()); }
    bool is_join() const { return join_; }

    /// Replaces `columns` by the b of all pairs (a, b), ascending. Requires: a < rows(). Thread safety: full.
    /// Complexity: O(log n + pairs log pairs) for small boxes; O(sqrt(n)) and more for rods that cross.
    void row(std::uint32_t a, std::vector<std::uint32_t>& columns) const;
    /// Like row(), in no particular order.
    void unordered_row(std::uint32_t a, std::vector<std::uint32_t>& columns) const;

    /// Returns whether (a, b) is a pair. Requires: a < rows(), b < columns(); b > a within one set. Thread safety: full.
    bool is_pair(std::uint32_t a, std::uint32_t b) const;

private:
    using Tree = std::variant<BoxTree<float>, BoxTree<double>>;
    const Objects& searched() const { return join_ ? second_ : first_; }
    BoxQuery query_of(std::uint32_t a) const;

    Objects first_, second_;
    bool join_;
    double margin_;
    std::function<bool(std::uint32_t a, std::uint32_t b)> allows_;
    Tree tree_;
};

}  // namespace octopair
