// WorkSharing: divides each step of a pass among the workers.
//
// Invariants
//   All workers run the same steps in the same order, with the same numbers of shares.
//   Workers claim shares one by one. Each worker leaves a step only when all shares of the step are done.
//   A replacement worker runs the same steps from the first one. It skips shares that are done, and runs again the share
//   that its slot had claimed.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>

#include "engine/processes/shared_memory/control_block.hpp"

namespace octopair {

/// A moment in the commit of a share. After the commit, ShareObserver::end() is called.
enum class CommitPoint : std::uint8_t { before, within };

/// Receives the progress of a worker. Fault tests use an observer to make a worker fail; octopair-worker has none.
class ShareObserver {
public:
    virtual ~ShareObserver() = default;
    virtual void begin(Step step) = 0;
    virtual void tick() = 0;  ///< repeatedly during a share
    virtual void reach(CommitPoint point) = 0;
    virtual void end() = 0;  ///< the share is committed, but not yet marked done
};

class WorkSharing {
public:
    struct Self {
        unsigned slot;
        std::uint32_t pass;
        ShareObserver* observer = nullptr;
    };
    WorkSharing(ControlBlockView& view, const Self& self, std::stop_token stop);

    /// A share that this worker has claimed.
    struct ClaimedShare {
        std::uint64_t index;   ///< number of the share in its step
        std::uint64_t number;  ///< number of the share in its pass
        Share& record;
    };
    using Body = std::function<void(const ClaimedShare&)>;

    /// Runs a step of `count` shares: calls `body` for each share that this worker claims, then waits until all are done.
    /// Throws: Error{cancelled}; what `body` throws.
    void run(Step step, std::uint64_t count, const Body& body);

    /// Number of shares of all steps so far.
    std::uint64_t shares() const { return next_; }
    unsigned slot() const { return self_.slot; }
    std::uint32_t pass() const { return self_.pass; }
    ShareObserver* observer() const { return self_.observer; }
    /// Notifies the observer.
    void reach(CommitPoint point) const {
        if (self_.observer != nullptr) self_.observer->reach(point);
    }

private:
    bool claim(Share& record) const;
    void do_share(const ClaimedShare& share, const Body& body);
    void wait_for_others(std::span<Share> records);

    ControlBlockView& view_;
    Slot& slot_;
    Self self_;
    std::stop_token stop_;
    std::uint64_t next_ = 0;  // number of the next step's first share
};

}  // namespace octopair
