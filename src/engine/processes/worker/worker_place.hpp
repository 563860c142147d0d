// WorkerPlace: where the outputs of a worker (engine/output/outputs.hpp) take memory for pairs, and where they record shares.
//
// The record of a share is visible when the share is marked done, after its commit. If the worker dies before, a replacement worker
// runs the share again, and overwrites the record. Blocks that the dead worker took stay unused.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>

#include "engine/output/outputs.hpp"
#include "engine/processes/worker/work_sharing.hpp"

namespace octopair {

/// The region `pairs`, and the tables of the control block. Borrows both.
struct WorkerPlace {
    using Share = WorkSharing::ClaimedShare;

    ControlBlockView& view;
    SharedMemory& pairs;
    const WorkSharing& shares;
    std::stop_token stop;

    /// Returns unused memory of the region. Throws: Error{resource_limit}.
    std::span<Pair> take_block(std::size_t pairs) const;
    void record(const Share& share, std::uint64_t pairs) const;
    void check(std::uint64_t) const {}  // the client checks the numbers of pairs
    void record(const Share& share, const PairRuns& runs) const;
};

/// Writes each share's pairs to the slot's ring, block by block, for the client to read. Waits while the ring is full.
/// The client drops the blocks of a share whose worker died before the share's last block.
class RingOutput final : public FullOutput {
public:
    RingOutput(const WorkerPlace& place, const Pass& pass)
        : place_(place), pass_(pass), slot_(place.view.slot(place.shares.slot())) {}

    void begin(const WorkerPlace::Share& share);
    void commit(const WorkerPlace::Share& share);
    void write(std::span<const Pair> pairs) override;

private:
    std::span<Pair> free_block();
    void hand_over(bool last);

    WorkerPlace place_;
    const Pass& pass_;
    Slot& slot_;
    std::uint64_t share_ = 0;
    std::span<Pair> block_;
    std::size_t held_ = 0;  // pairs in block_
};

}  // namespace octopair
