// PassRunner: the work of one worker in a pass. All workers of a pass run the same program concurrently.
#pragma once

#include <cstdint>
#include <memory>
#include <stop_token>

#include "boxes/box_source.hpp"
#include "engine/processes/shared_memory/shared_memory.hpp"
#include "engine/processes/worker/work_sharing.hpp"
#include "engine/processes/worker/worker_place.hpp"
#include "engine/processes/worker/worker_regions.hpp"
#include "octree/build/linear_octree.hpp"
#include "octree/scan/scan.hpp"

namespace octopair {

/// Keeps the octree between the passes of a job. Thread safety: one thread at a time.
class PassRunner {
public:
    /// Requires: `view` and `regions` outlive this object.
    PassRunner(ControlBlockView& view, WorkerRegions& regions);
    ~PassRunner();

    /// Runs this worker's part of the pass and stores the outcome in its slot.
    void run(const Pass& pass, const WorkSharing::Self& self, std::stop_token stop);
    /// Frees the memory of the last job. A later pass of that job starts the job again.
    void forget_job();

private:
    struct Job;
    class BuildExecutor;
    template <typename Output>
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
    void scan(const Context& context);
    template <typename Output>
    void scan_into(const Context& context, Output output);
    void count_by_object(const Context& context);

    ControlBlockView& view_;
    WorkerRegions& regions_;
    std::unique_ptr<Job> job_;
    ScanMemoryPool scan_memory_;
};

}  // namespace octopair
