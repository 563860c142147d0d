// Where the pairs of a worker's shares go, in each kind of pass.
//
// A share's pairs become visible when the share is done, all at once; but those of a stream as they come.
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
    /// Of the share that begins; the last one is over. Valid until the next.
    virtual ShareWriter& begin(const WorkSharing::Task& task) = 0;
    /// Completes the record of the share that began.
    virtual void end(const WorkSharing::Task& task) = 0;
};

/// What outputs write to.
struct OutputPlace {
    ControlBlockView& view;
    SharedMemory& pairs;
    const WorkSharing& shares;
    std::stop_token stop;
};

/// Counts the pairs of each share.
std::unique_ptr<ShareOutput> make_count_output();
/// Counts the pairs of each object, together with the other workers.
std::unique_ptr<ShareOutput> make_count_by_object_output(std::span<std::uint32_t> counts);
/// Lists the pairs of each share.
std::unique_ptr<ShareOutput> make_list_output(const OutputPlace& place);
/// Hands each share's pairs to the client, block by block; waits while it holds as many as it may.
std::unique_ptr<ShareOutput> make_stream_output(const OutputPlace& place, const Pass& pass);

/// The next block of the region `pairs`. Throws Error{resource_limit}.
std::span<Pair> take_block(const OutputPlace& place);
/// Makes `runs` the result of a share.
void record_runs(const OutputPlace& place, std::span<const std::span<const Pair>> runs, Share& record);

}  // namespace octopair
