#include "engine/threads/team_output.hpp"

#include <algorithm>
#include <atomic>
#include <utility>
#include <vector>

#include "engine/output/outputs.hpp"
#include "octopair/error.hpp"

namespace octopair {

void TeamExecutor::for_each(std::size_t count, const std::function<void(std::size_t)>& body) {
    team_.for_each(count, [&](std::size_t i, unsigned) { body(i); });
}

void TeamExecutor::for_each_writing(std::size_t, const std::function<void(std::size_t, ShareWriter&)>&) {
    throw Error(ErrorCode::engine_failed, "a step without an output for pairs wrote pairs");
}

namespace {

/// Gives each thread an output. Numbers shares by their order in the search.
template <typename Output>
class OutputExecutor final : public TeamExecutor {
public:
    /// `output_of(thread)` returns the output of a thread.
    template <typename OutputOf>
    OutputExecutor(Team& team, const OutputOf& output_of) : TeamExecutor(team) {
        outputs_.reserve(team.threads());
        for (unsigned thread = 0; thread < team.threads(); ++thread) outputs_.push_back({output_of(thread)});
    }
    void for_each_writing(std::size_t count, const std::function<void(std::size_t, ShareWriter&)>& body) override {
        team().for_each(count, [&](std::size_t i, unsigned thread) {
            Output& output = outputs_[thread].output;
            const std::uint64_t share = shares_ + i;
            output.begin(share);
            body(i, output);
            output.commit(share);
        });
        shares_ += count;
    }
    Output& output(unsigned thread) { return outputs_[thread].output; }

private:
    /// In cache lines of its own, because each thread writes to its output all the time.
    struct alignas(64) OfThread {
        Output output;
    };
    std::vector<OfThread> outputs_;
    std::uint64_t shares_ = 0;  // of earlier steps
};

/// Thrown by a share when enough pairs are counted.
struct CountedEnough {};

/// Adds the numbers of pairs of all shares.
struct CountPlace {
    std::atomic<std::uint64_t>& all;
    const CountLimit& limit;
    void record(std::uint64_t, std::uint64_t pairs) { all += pairs; }
    void check(std::uint64_t pairs) const {
        if (!limit.reached(all.load(std::memory_order_relaxed) + pairs)) return;
        all += pairs;
        throw CountedEnough{};
    }
};

/// A run of a committed share.
struct CommittedRun {
    std::uint64_t share;
    std::span<const Pair> run;
};

/// Blocks of a list, and the runs of the shares that one thread has committed.
struct ListPlace {
    detail::PairStorage& list;
    std::vector<CommittedRun>& committed;

    std::span<Pair> take_block(std::size_t pairs) { return list.take_block(pairs); }
    void record(std::uint64_t share, const PairRuns& runs) {
        for (const auto run : runs.view()) committed.push_back({share, run});
    }
};

/// Pages of one thread. The buckets are the record of its shares.
struct BucketPlace {
    Pages* memory;
    Pages& pages() { return *memory; }
    void begin(const std::vector<PageString>&) {}
    void record(std::uint64_t, const std::vector<PageString>&) {}
};

}  // namespace

PairCount count_pairs(Team& team, const FindPairs& find, const CountLimit& limit) {
    std::atomic<std::uint64_t> pairs = 0;
    OutputExecutor<CountOutput<CountPlace>> executor(team, [&](unsigned) {
        return CountOutput(CountPlace{pairs, limit});
    });
    try {
        find(executor);
    } catch (const CountedEnough&) {
        return {pairs - 1, false};
    }
    return {pairs};
}

void count_pairs_by_object(Team& team, std::span<std::uint32_t> counts, const FindPairs& find) {
    OutputExecutor<BinCountOutput<std::uint32_t>> executor(team, [&](unsigned) { return BinCountOutput(counts); });
    find(executor);
}

void count_pairs_by_bin(Team& team, std::span<std::uint64_t> counts, unsigned bin_shift, const FindPairs& find) {
    OutputExecutor<BinCountOutput<std::uint64_t>> executor(team,
                                                           [&](unsigned) { return BinCountOutput(counts, bin_shift); });
    find(executor);
}

void list_pairs(Team& team, detail::PairStorage& list, const FindPairs& find) {
    std::vector<std::vector<CommittedRun>> of_thread(team.threads());
    OutputExecutor<ListOutput<ListPlace>> executor(team, [&](unsigned thread) {
        return ListOutput(ListPlace{list, of_thread[thread]});
    });
    find(executor);
    std::vector<CommittedRun> all;
    for (const auto& runs : of_thread) all.insert(all.end(), runs.begin(), runs.end());
    std::ranges::stable_sort(all, {}, &CommittedRun::share);
    for (const CommittedRun& committed : all) list.append(committed.run);
}

// NOLINTNEXTLINE(readability-function-size): team, list, bounds, search, control.
void list_ascending_pairs(Team& team, detail::PairStorage& list, const AscendingBounds& bounds, const FindPairs& find,
                          const SortControl& control) {
    constexpr std::size_t pages_at_once = 64;  // minimum number of pages of a block
    const BucketPlan plan(bounds, team.threads());
    std::atomic<std::int64_t> pages_left = std::int64_t(bounds.max_pairs / page_pairs());
    std::atomic<std::uint64_t> pages_taken = 0;
    PageBudget budget(pages_left, pages_taken);
    std::vector<Pages> pages;
    pages.reserve(team.threads());
    for (unsigned thread = 0; thread < team.threads(); ++thread)
        pages.emplace_back([&] { return list.take_block(pages_at_once * page_pairs()); }, budget);
    OutputExecutor<AscendingOutput<BucketPlace>> executor(
        team, [&](unsigned thread) { return AscendingOutput(plan, BucketPlace{&pages[thread]}); });
    find(executor);

    std::vector<std::vector<PageString>> found;
    std::uint64_t all = 0;
    std::vector<BucketSort> sorts;
    for (unsigned thread = 0; thread < team.threads(); ++thread) {
        found.push_back(std::move(executor.output(thread).buckets()));
        all += pairs_in(found.back());
        sorts.emplace_back(plan, pages[thread]);
    }
    if (control.begin) control.begin(all);
    budget.end();
    std::vector<BucketSort::Runs> sorted(plan.buckets());
    team.for_each(sorted.size(), [&](std::size_t bucket, unsigned thread) {
        std::vector<PageString> strings = take_bucket(found, bucket);
        const std::uint64_t pairs = pairs_in(strings);
        sorted[bucket] = sorts[thread].sort(std::move(strings), control.stop);
        if (control.sorted) control.sorted(pairs);
    });
    for (const auto& runs : sorted) {
        for (const auto run : runs) list.append(run);
    }
}

}  // namespace octopair
