// ExactPairs: the pairs of the objects' own boxes, for a scene with slack. A searched box contains the own box, so these pairs are among
// the pairs of the searched boxes.
#pragma once

#include <vector>

#include "parallel/team.hpp"
#include "scene/object_table.hpp"
#include "scene/pair_history.hpp"

namespace octopair {

class ExactPairs {
public:
    /// `room`: as for PairHistory.
    ExactPairs(Team& team, PairHistory::Room room) : team_(team), history_(std::move(room)) {}

    /// Finds the pairs among `candidates`, which are the pairs of the searched boxes. Stores what changed in `changes`.
    /// If it throws, only `changes` has been modified.
    void update(const PairList& candidates, const ObjectTable& table, double margin, PairChanges& changes);
    PairHistory& history() { return history_; }

private:
    /// A run of candidates, and the pairs among them.
    struct Part {
        std::span<const Pair> candidates;
        Pair* pairs;
        std::size_t count = 0;
    };

    void divide(const PairList& candidates, std::span<Pair> room);

    Team& team_;
    PairHistory history_;
    std::vector<Part> parts_;
};

}  // namespace octopair
