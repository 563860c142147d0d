// ProcessPasses: the passes of a call, made by a pool of workers.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "engine/processes/client/worker_pool.hpp"
#include "engine/processes/client/shared_inputs.hpp"
#include "engine/search.hpp"

namespace octopair {

class ProcessPasses final : public Passes {
public:
    /// Both must outlive it.
    ProcessPasses(WorkerPool& pool, const SharedArrays& arrays);

    unsigned width() const override { return pool_.workers(); }
    void end() noexcept override { regions_.clear(); }
    /// The octree is built by the pass that comes next: one errand for both.
    void build(Call& call, double progress) override;
    std::uint64_t count(Call& call, double progress) override;
    void count_by_object(Call& call, std::span<std::uint32_t> counts, double progress) override;
    void list_octal(Call& call, detail::PairStorage& list, double progress) override;
    void stream_octal(Call& call, const Deliver& deliver, double progress) override;
    void list_ascending(Call& call, detail::PairStorage& list, const AscendingBounds& bounds, double progress) override;

private:
    void run(Call& call, double progress, const std::shared_ptr<Region>& pairs, PassWatch watch);
    void show_progress(Call& call, std::uint64_t& shown);
    void take_results(Call& call);
    void append_runs(detail::PairStorage& list, const std::shared_ptr<Region>& pairs);
    std::shared_ptr<Region> free_pairs();
    std::span<Share> shares_done();

    WorkerPool& pool_;
    SharedInputs inputs_;
    std::shared_ptr<Region> arena_;
    std::vector<std::shared_ptr<Region>> pairs_;  // with one owner, they are free
    Pass pass_;
    std::vector<std::shared_ptr<Region>> regions_;  // that each pass of the call needs, beside one for its pairs
};

}  // namespace octopair
