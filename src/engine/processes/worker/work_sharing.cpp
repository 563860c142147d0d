#include "engine/processes/worker/work_sharing.hpp"

#include <utility>

#include "base/stop.hpp"
#include "engine/processes/worker_timeouts.hpp"

namespace octopair {

WorkSharing::WorkSharing(ControlBlockView& view, const Self& self, std::stop_token stop)
    : view_(view), slot_(view.slot(self.slot)), self_(self), stop_(std::move(stop)) {}

void WorkSharing::run(Step step, std::uint64_t count, const Body& body) {
    const std::uint64_t first = next_;
    const auto records = view_.shares(first, count);
    next_ += count;
    slot_.preparing.store(0);
    for (std::uint64_t i = 0; i < count; ++i) {
        Share& record = records[i];
        record.step.store(std::uint32_t(step));
        if (!claim(record)) continue;
        throw_if_stopped(stop_);
        do_share({i, first + i, record}, body);
    }
    view_.control_block().among_workers.raise();
    wait_for_others(records);
}

/// Claims a share for this slot. Returns true if the share was free, or if a worker of this slot claimed it and died.
bool WorkSharing::claim(Share& record) const {
    std::uint64_t packed = record.state.load();
    const ShareState mine{self_.pass, ShareStatus::claimed, self_.slot};
    while (ShareState::of(packed).pass != self_.pass) {
        if (record.state.compare_exchange_weak(packed, mine.packed())) return true;
    }
    return packed == mine.packed();
}

void WorkSharing::do_share(const ClaimedShare& share, const Body& body) {
    Share& record = share.record;
    slot_.share.store(share.number + 1);
    record.pairs = record.first_run = record.commit = 0;
    record.runs = 0;
    if (self_.observer != nullptr) self_.observer->begin(Step(record.step.load()));
    body(share);
    if (self_.observer != nullptr) self_.observer->end();
    record.state.store(ShareState{self_.pass, ShareStatus::done, self_.slot}.packed());
    slot_.share.store(0);
}

void WorkSharing::wait_for_others(std::span<Share> records) {
    EventCount& event = view_.control_block().among_workers;
    std::size_t done = 0;
    for (;;) {
        const std::uint32_t seen = event.count.load();
        while (done < records.size() && ShareState::of(records[done].state.load()).is(self_.pass, ShareStatus::done)) {
            ++done;
        }
        if (done == records.size()) return;
        throw_if_stopped(stop_);
        const WaitingMark waiting(slot_);
        event.wait(seen, worker_timeouts::max_event_sleep, worker_timeouts::max_spins_for_event);
    }
}

}  // namespace octopair
