// BatchAccess: internal access to a Batch, for code that fills, truncates and reuses batches.
#pragma once

#include <span>
#include <stop_token>
#include <utility>

#include "octopair/pipeline.hpp"

namespace octopair::detail {

struct BatchAccess {
    /// Empties the batch for new pairs, and keeps its memory.
    static void restart(Batch& batch, const std::stop_token& stop) {
        batch.pairs_.clear();
        batch.findings_.clear();
        batch.undecided_ = 0;
        batch.stop_ = stop;
    }

    static void append(Batch& batch, std::span<const Pair> pairs) {
        batch.pairs_.insert(batch.pairs_.end(), pairs.begin(), pairs.end());
    }

    /// Returns the count of Batch::count_undecided() since the last call or restart().
    static std::uint64_t take_undecided(Batch& batch) { return std::exchange(batch.undecided_, 0); }

    /// Truncates the batch to its first `pairs` pairs and their findings, and keeps its memory.
    static void cut(Batch& batch, std::size_t pairs) {
        batch.pairs_.resize(pairs);
        if (!batch.findings_.empty()) batch.findings_.resize(pairs);
    }
};

}  // namespace octopair::detail
