// The ascending order of pairs: by a, then b.
#pragma once

#include <cstdint>
#include <stop_token>

#include "engine/local/writers.hpp"
#include "engine/pair_list.hpp"

namespace octopair {

struct AscendingOrder {
    Team& team;
    std::stop_token stop;

    /// Appends the pairs of `unsorted`, all of whose `a` are in `range`, to `sorted` in ascending order. Pairs are
    /// distinct. Throws Error{cancelled}.
    void append(const PairList::Storage& unsorted, ObjectRange range, PairList::Storage& sorted) const;
};

}  // namespace octopair
