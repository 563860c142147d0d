// ProcessPasses: runs the passes of a call on a pool of worker processes.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "engine/passes.hpp"
#include "engine/processes/client/shared_inputs.hpp"
#include "engine/processes/client/worker_pool.hpp"

namespace octopair {

class ProcessPasses {
public:
    /// Requires: `pool` and `arrays` outlive this object.
    ProcessPasses(WorkerPool& pool, const SharedArrays& arrays);

    unsigned width() const { return pool_.workers(); }
    void end() noexcept { regions_.clear(); }
    /// Prepares the inputs. The next pass builds the octree, so workers need only one request for both.
    void build(Call& call, double progress);
    PairCount count(Call& call, double progress, const CountLimit& limit);
    void count_by_object(Call& call, std::span<std::uint32_t> counts, double progress);
    void list_octal(Call& call, detail::PairStorage& list, double progress);
    void stream_octal(Call& call, const PairSink& deliver, double progress);
    void list_ascending(Call& call, detail::PairStorage& list, const AscendingBounds& bounds, double progress);

private:
    /// The work of a pass that has been reported as progress of the call.
    struct PassProgress {
        double end = 1;          // progress of the call at the end of the pass
        bool scanning = false;   // a worker scans entries, so that their number is known
        bool ordering = false;   // the workers sort pairs
        std::uint64_t done = 0;  // scanned entries or sorted pairs
    };

    void run(Call& call, double progress, const std::shared_ptr<Region>& pairs, PassWatch watch);
    void show_progress(Call& call, PassProgress& shown);
    void take_results(Call& call);
    void run_list(Call& call, double progress, const detail::PairStorage& list, const std::shared_ptr<Region>& pairs);
    bool check_growth(Call& call, const SharedMemory& pairs);
    void append_runs(detail::PairStorage& list, const std::shared_ptr<Region>& pairs);
    std::shared_ptr<Region> free_pairs();
    std::span<Share> shares_done();

    WorkerPool& pool_;
    SharedInputs inputs_;
    std::shared_ptr<Region> arena_;
    std::vector<std::shared_ptr<Region>> pairs_;  // for pairs; a region that no list owns as well is free
    Pass pass_;
    std::vector<std::shared_ptr<Region>> regions_;  // needed by each pass of the call, apart from the pairs' region
};

}  // namespace octopair
