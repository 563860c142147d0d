// What a worker does in a pass: the program that all workers of a pass run side by side.
#pragma once

#include <cstdint>
#include <memory>
#include <stop_token>

#include "boxes/box_source.hpp"
#include "engine/processes/shared_memory/arena.hpp"
#include "engine/processes/worker/work_sharing.hpp"
#include "engine/processes/worker/share_output.hpp"
#include "engine/processes/worker/worker_regions.hpp"
#include "octree/linear_octree.hpp"

namespace octopair {

/// Keeps the octree from pass to pass of a job. One thread at a time.
class WorkerProgram {
public:
    /// Both must outlive it.
    WorkerProgram(ControlBlockView& view, WorkerRegions& regions);
    ~WorkerProgram();

    /// Does a part of the pass and leaves in its slot how that ended.
    void run(const Pass& pass, const WorkSharing::Self& self, std::stop_token stop);
    /// Lets go of the memory of the last job. No harm if a pass of it follows.
    void forget_job();

private:
    struct Job;
    class BuildExecutor;
    class ScanExecutor;
    struct Context {
        const Pass& pass;
        WorkSharing& shares;
        std::stop_token stop;
        Slot& slot;
    };
    Outcome take_part(const Context& context);
    void start_job(const Pass& pass);
    void build(const Context& context);
    void make_lists(const Context& context);
    void scan(const Context& context);
    void scan_into(const Context& context, ShareOutput& output);
    void count_by_object(const Context& context);

    ControlBlockView& view_;
    WorkerRegions& regions_;
    std::unique_ptr<Job> job_;
};

}  // namespace octopair
