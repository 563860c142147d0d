// KeptEngine: an engine of the server. It can be made anew while no job uses it, which gives back the memory that it keeps for later jobs.
#pragma once

#include <functional>
#include <memory>
#include <mutex>

#include "octopair/engine.hpp"

namespace octopair::service {

/// Makes an engine with `width` threads or workers.
using EngineMaker = std::function<std::unique_ptr<Engine>(unsigned width)>;

/// Thread safety: any thread may call it.
class KeptEngine {
public:
    KeptEngine(const EngineMaker& maker, unsigned width) : maker_(maker), width_(width), engine_(maker_(width_)) {}

    /// Returns the engine. It is in use while a copy of the pointer exists.
    std::shared_ptr<Engine> use() {
        const std::lock_guard lock(mutex_);
        was_used_ = true;
        return engine_;
    }

    /// Makes the engine anew if it was used, and is not in use now. Throws: what the maker throws; the engine stays then.
    void renew() {
        std::shared_ptr<Engine> old;  // destroyed after the lock is released
        const std::lock_guard lock(mutex_);
        if (!was_used_ || engine_.use_count() > 1) return;
        old = maker_(width_);
        old.swap(engine_);
        was_used_ = false;
    }

private:
    const EngineMaker maker_;
    const unsigned width_;
    std::mutex mutex_;
    std::shared_ptr<Engine> engine_;
    bool was_used_ = false;  // since it was made
};

}  // namespace octopair::service
