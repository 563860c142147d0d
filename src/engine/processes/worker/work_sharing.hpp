// WorkSharing: how the workers of a pass share out each step among them.
//
// All workers come to the same steps in the same order, each with the number of its shares. They claim shares one by one,
// and leave a step when all of its shares are done, whoever did them. A worker that takes over a slot in the middle of a
// pass goes through the same steps: what is done it passes over, what its slot had claimed it does.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>

#include "engine/processes/shared_memory/control_block.hpp"

namespace octopair {

/// Is told where a worker is: what tests of faults look at, and let happen. The worker's program has none.
class ShareObserver {
public:
    virtual ~ShareObserver() = default;
    virtual void begin(Step step) = 0;
    virtual void tick() = 0;  ///< now and then within a share
    virtual void end() = 0;   ///< the share is complete, but not yet said to be done
};

class WorkSharing {
public:
    struct Self {
        unsigned slot;
        std::uint32_t pass;
        ShareObserver* observer = nullptr;
    };
    WorkSharing(ControlBlockView& view, const Self& self, std::stop_token stop);

    struct Task {
        std::uint64_t index;   ///< within the step
        std::uint64_t number;  ///< within the pass
        Share& record;
    };
    using Body = std::function<void(const Task&)>;

    /// Calls `body` for some of `count` shares, and returns when the others are done as well. Throws Error{cancelled},
    /// and what `body` throws.
    void run(Step step, std::uint64_t count, const Body& body);

    /// Shares of all steps so far.
    std::uint64_t shares() const { return next_; }
    unsigned slot() const { return self_.slot; }
    std::uint32_t pass() const { return self_.pass; }
    ShareObserver* observer() const { return self_.observer; }

private:
    bool claim(Share& record) const;
    void do_share(const Task& task, const Body& body);
    void wait_for_others(std::span<Share> records);

    ControlBlockView& view_;
    Slot& slot_;
    Self self_;
    std::stop_token stop_;
    std::uint64_t next_ = 0;
};

}  // namespace octopair
