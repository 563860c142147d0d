// MessageTape: what a rank got from the others in a call, so that it can make the same call again without them.
//
// For measurements: where more ranks than cores take turns, each finds the caches full of the others' data. A rank that
// repeats its part alone costs what it would on a machine of its own. And for looking at what one rank of many does.
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
    /// Of the next call, which is collective.
    void record() {
        results_.clear();
        replaying_ = false;
    }
    /// The next call, which must be the same, is this rank's alone.
    void replay() {
        next_ = 0;
        replaying_ = true;
    }
    bool replaying() const { return replaying_; }

    void take(std::span<const std::byte> result) { results_.emplace_back(result.begin(), result.end()); }
    void give(std::span<std::byte> result) {
        if (next_ >= results_.size() || results_[next_].size() != result.size()) {
            throw Error(ErrorCode::engine_failed, "not the call that was recorded");
        }
        std::ranges::copy(results_[next_++], result.begin());
    }

private:
    std::vector<std::vector<std::byte>> results_;  // of each collective function
    std::size_t next_ = 0;
    bool replaying_ = false;
};

/// Of an MPI engine's calls from now on; null: none. Borrowed. Throws Error{usage} unless make_mpi_engine made the engine.
void use_tape(Engine& engine, MessageTape* tape);

}  // namespace octopair
