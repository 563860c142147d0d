// ShareOutput: the output for the pairs of a worker's shares. Each kind of pass has its own output.
//
// The client sees the pairs of a share all at once, when the share is done. Only in a stream, it sees each block as soon as the block is
// full.
#pragma once

#include <memory>
#include <span>
#include <stop_token>

#include "engine/processes/worker/work_sharing.hpp"
#include "octree/executor.hpp"

namespace octopair {

class ShareOutput {
public:
    virtual ~ShareOutput() = default;
    /// Begins a share. Returns its writer, valid until the next begin(). Requires: the previous share has ended.
    virtual ShareWriter& begin(const WorkSharing::ClaimedShare& share) = 0;
    /// Completes the record of the current share.
    virtual void end(const WorkSharing::ClaimedShare& share) = 0;
};

/// Destination of outputs: the tables and the region `pairs`.
struct OutputPlace {
    ControlBlockView& view;
    SharedMemory& pairs;
    const WorkSharing& shares;
    std::stop_token stop;
};

/// Counts the pairs of each share.
std::unique_ptr<ShareOutput> make_count_output();
/// Adds the number of pairs of each object to `counts`, which all workers share.
std::unique_ptr<ShareOutput> make_count_by_object_output(std::span<std::uint32_t> counts);
/// Lists the pairs of each share.
std::unique_ptr<ShareOutput> make_list_output(const OutputPlace& place);
/// Writes each share's pairs to the slot's ring, block by block. Waits while the ring is full.
std::unique_ptr<ShareOutput> make_stream_output(const OutputPlace& place, const Pass& pass);

/// Returns the next unused block of the region `pairs`. Throws: Error{resource_limit}.
std::span<Pair> take_block(const OutputPlace& place);
/// Stores `runs` as the result of a share in its record.
void record_runs(const OutputPlace& place, std::span<const std::span<const Pair>> runs, Share& record);

}  // namespace octopair
