#include "engine/mpi/rank_passes.hpp"

#include <atomic>

#include "engine/threads/writers.hpp"

namespace octopair {

void RankPasses::build(Call& call, double progress) {
    call.progress.stage(progress, 1);
    TeamExecutor threads(team());
    RankExecutor executor(threads, *stops_);
    positioned_.reset();
    if (share_.positions) positioned_.emplace(call.source, *share_.positions);
    const EntrySource& source = positioned_ ? static_cast<const EntrySource&>(*positioned_) : call.source;
    octree().build(std::move(share_.layout), source, executor, call.stop.get_token());
    call.summary.entries = octree().entry_count(share_.begin, share_.end);
    call.summary.steps.encode = octree().seconds().encode;
    call.summary.steps.count = octree().seconds().count;
    call.summary.steps.scatter = octree().seconds().scatter;
}

const PairRule& RankPasses::pair_rule(const Call& call) const {
    return positioned_ ? static_cast<const PairRule&>(*positioned_) : call.source;
}

namespace {

class RowCountWriter final : public FullWriter {
public:
    RowCountWriter(const RowBins& bins, std::span<std::uint64_t> counts) : bins_(bins), counts_(counts) {}
    void write(std::span<const Pair> pairs) override {
        for (const Pair& pair : pairs) {
            std::atomic_ref(counts_[bins_.bin(pair)]).fetch_add(1, std::memory_order_relaxed);
        }
    }

private:
    const RowBins& bins_;
    std::span<std::uint64_t> counts_;
};

/// Gives each share a writer that counts the pairs of each bin.
class RowCountExecutor final : public TeamExecutor {
public:
    RowCountExecutor(Team& team, const RowBins& bins, std::span<std::uint64_t> counts)
        : TeamExecutor(team), bins_(bins), counts_(counts) {}
    void for_each_writing(std::size_t count, const std::function<void(std::size_t, ShareWriter&)>& body) override {
        team().for_each(count, [&](std::size_t i, unsigned) {
            RowCountWriter writer(bins_, counts_);
            body(i, writer);
        });
    }

private:
    const RowBins& bins_;
    std::span<std::uint64_t> counts_;
};

}  // namespace

void RankPasses::count_rows(Call& call, const RowBins& bins, std::span<std::uint64_t> counts, double progress) {
    RowCountExecutor executor(team(), bins, counts);
    scan_into(call, executor, progress);
}

void RankPasses::scan_into(Call& call, Executor& executor, double progress) {
    RankExecutor wanted(executor, *stops_, wanted_);
    ThreadPasses::scan_into(call, {octree(), share_.begin, share_.end}, wanted, progress);
}

}  // namespace octopair
