// What a batch is made of, for those that fill it, cut it off and empty it again.
#pragma once

#include <span>
#include <stop_token>

#include "octopair/pipeline.hpp"

namespace octopair::detail {

struct BatchAccess {
    /// Empties it for other pairs; its memory is kept.
    static void restart(Batch& batch, const std::stop_token& stop) {
        batch.pairs_.clear();
        batch.findings_.clear();
        batch.stop_ = stop;
    }

    static void append(Batch& batch, std::span<const Pair> pairs) {
        batch.pairs_.insert(batch.pairs_.end(), pairs.begin(), pairs.end());
    }

    /// The first so many pairs stay, with what is known of them; memory is kept.
    static void cut(Batch& batch, std::size_t pairs) {
        batch.pairs_.resize(pairs);
        if (!batch.findings_.empty()) batch.findings_.resize(pairs);
    }
};

}  // namespace octopair::detail
