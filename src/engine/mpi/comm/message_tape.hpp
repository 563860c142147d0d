// MessageTape: records the data that a rank receives from others in a call, so that the rank can repeat the call alone.
//
// Purpose    measurements with more ranks than cores: ranks that take turns evict each other's data from the caches. A rank
//            that repeats its part alone costs what it would cost on a machine of its own. The tape also helps to examine one
//            rank of many.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "octopair/engine.hpp"
#include "octopair/error.hpp"

namespace octopair {

class MessageTape {
public:
    /// Records the next call, which is collective.
    void record() {
        results_.clear();
        replaying_ = false;
    }
    /// Replays the recorded call on this rank alone. Requires: the next call equals the recorded one.
    void replay() {
        next_ = 0;
        replaying_ = true;
    }
    bool replaying() const { return replaying_; }

    void take(std::span<const std::byte> result) { results_.emplace_back(result.begin(), result.end()); }
    void give(std::span<std::byte> result) {
        if (next_ >= results_.size() || results_[next_].size() != result.size()) {
            throw Error(ErrorCode::engine_failed, "the replayed call differs from the recorded call");
        }
        std::ranges::copy(results_[next_++], result.begin());
    }

private:
    std::vector<std::vector<std::byte>> results_;  // result of each collective function, in the order of the calls
    std::size_t next_ = 0;
    bool replaying_ = false;
};

/// Sets the tape of the later calls of an MPI engine; null: none. Borrows `tape`.
/// Throws: Error{usage} unless make_mpi_engine made the engine.
void use_tape(Engine& engine, MessageTape* tape);

}  // namespace octopair
