// ThreadPasses: scans a linear octree on the threads of this process, into each kind of output.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>
#include <utility>

#include "base/timed.hpp"
#include "engine/passes.hpp"
#include "engine/threads/team_output.hpp"
#include "octree/build/linear_octree.hpp"
#include "octree/scan/scan.hpp"
#include "parallel/team.hpp"

namespace octopair {

/// One scan: writes pairs in shares of the executor, and advances the progress of the call to the fraction `progress`.
struct ThreadScan {
    Call& call;
    Executor& executor;
    double progress;
    std::stop_token stop;
};

class ThreadPasses {
public:
    using Scan = std::function<void(const ThreadScan&)>;
    /// `scan` calls scan_octants().
    ThreadPasses(unsigned threads, Scan scan) : team_(threads), scan_(std::move(scan)) {}

    unsigned width() const { return team_.threads(); }
    PairCount count(Call& call, double progress, const CountLimit& limit = {}) {
        return count_pairs(team_, scan_into(call, progress), limit);
    }
    void count_by_object(Call& call, std::span<std::uint32_t> counts, double progress) {
        count_pairs_by_object(team_, counts, scan_into(call, progress));
    }
    void list_octal(Call& call, detail::PairStorage& list, double progress) {
        list_pairs(team_, list, scan_into(call, progress));
    }
    void stream_octal(Call& call, const PairSink& deliver, double progress) {
        // An exception of `deliver` ends this scan alone: the call may scan again.
        std::stop_source abandon;
        const std::stop_callback forward(call.stop.get_token(), [&] { abandon.request_stop(); });
        stream_pairs(team_, {deliver, call.buffer_pairs(), abandon}, [&](Executor& executor) {
            scan_({call, executor, progress, abandon.get_token()});
        });
    }
    void list_ascending(Call& call, detail::PairStorage& list, const AscendingBounds& bounds, double progress) {
        const double begin = call.progress.end();
        const auto begin_sort = [&](std::uint64_t pairs) {
            if (call.room != nullptr)
                call.room->require({pairs});  // ends the forecasts: the list grows while it is sorted
            call.progress.stage(progress, pairs);
        };
        const auto sorted = [&](std::uint64_t pairs) { call.progress.add(pairs); };
        list_ascending_pairs(team_, list, bounds, scan_into(call, begin + ascending_scan_part * (progress - begin)),
                             {call.stop.get_token(), begin_sort, sorted});
    }
    void end() {}

protected:
    Team& team() { return team_; }
    LinearOctree& octree() { return octree_; }

    /// Builds the octree with `build()`, and sets its times in the summary.
    template <typename Build>
    void build_octree(Call& call, double progress, Build&& build) {
        call.progress.stage(progress, 1);
        build();
        call.summary.steps.encode = octree_.seconds().encode;
        call.summary.steps.scatter = octree_.seconds().scatter;
        call.summary.steps.count = octree_.seconds().count;
    }
    /// Scans `octants` of the octree, which was built of `source`.
    void scan_octants(const ThreadScan& scan, const OctreeRange& octants, const EntrySource& source) {
        Call& call = scan.call;
        const Timed timed(call.summary.steps.scan);
        call.progress.stage(scan.progress, octants.octree.entry_count(octants.begin, octants.end));
        octopair::scan(octants, {source, scan.stop, scan_memory_}, scan.executor,
                       [&](std::uint64_t entries) { call.progress.add(entries); });
    }

    /// Returns a function that scans into an executor.
    FindPairs scan_into(Call& call, double progress) {
        return [this, &call, progress](Executor& executor) {
            scan_({call, executor, progress, call.stop.get_token()});
        };
    }

private:
    Team team_;
    LinearOctree octree_;
    ScanMemoryPool scan_memory_;
    Scan scan_;
};

}  // namespace octopair
