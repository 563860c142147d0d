// The paper's algorithm on threads: each slave is a thread, and so is each machine's merge.
#include <algorithm>
#include <chrono>
#include <exception>
#include <iterator>
#include <thread>
#include <utility>

#include "baselines/baselines.hpp"
#include "baselines/paper_steps.hpp"

namespace octopair::baselines {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

struct SlaveResult {
    PaperList entries;
    double octal_codes = 0, sort = 0;
};

/// Runs `work(i)` for i below `count`, each on its own thread. Throws: the exception of a call, for example when the
/// octants exceed the memory.
template <typename Work>
void run_side_by_side(std::size_t count, const Work& work) {
    std::vector<std::exception_ptr> failures(count);
    const auto guarded_work = [&](std::size_t i) {
        try {
            work(i);
        } catch (...) {
            failures[i] = std::current_exception();
        }
    };
    {
        std::vector<std::jthread> threads;
        threads.reserve(count);
        for (std::size_t i = 1; i < count; ++i) threads.emplace_back(guarded_work, i);
        if (count > 0) guarded_work(0);
    }
    for (const std::exception_ptr& failure : failures) {
        if (failure) std::rethrow_exception(failure);
    }
}

/// Runs steps 1 to 3 on all slaves, with equal shares of the objects.
std::vector<PaperList> run_slaves(std::span<const Box3f> boxes, const PaperSettings& settings, PaperSeconds& seconds) {
    const std::size_t slaves = std::size_t(settings.machines) * settings.slaves_per_machine;
    const PaperOctree octree = paper_octree(boxes, settings.level);
    std::vector<SlaveResult> results(slaves);
    run_side_by_side(slaves, [&](std::size_t slave) {
        const std::size_t first = boxes.size() * slave / slaves, last = boxes.size() * (slave + 1) / slaves;
        SlaveResult& result = results[slave];
        auto start = Clock::now();
        result.entries = paper_codes({boxes.subspan(first, last - first), std::uint32_t(first)}, octree);
        result.octal_codes = seconds_since(start);
        start = Clock::now();
        sort_entries(result.entries, settings.sort, octree.level);
        result.sort = seconds_since(start);
    });
    std::vector<PaperList> lists;
    for (SlaveResult& result : results) {
        seconds.octal_codes = std::max(seconds.octal_codes, result.octal_codes);
        seconds.sort = std::max(seconds.sort, result.sort);
        lists.push_back(std::move(result.entries));
    }
    return lists;
}

/// Merges the lists of each machine's slaves on that machine, all machines in parallel.
std::vector<PaperList> merge_on_machines(std::vector<PaperList> lists, unsigned machines) {
    const std::size_t per_machine = lists.size() / machines;
    std::vector<PaperList> merged(machines);
    run_side_by_side(machines, [&](std::size_t machine) {
        const auto first = lists.begin() + std::ptrdiff_t(machine * per_machine);
        const auto last = first + std::ptrdiff_t(per_machine);
        merged[machine] = merge_paper_lists({std::make_move_iterator(first), std::make_move_iterator(last)});
    });
    return merged;
}

}  // namespace

PaperResult paper_pairs(std::span<const Box3f> boxes, const PaperSettings& settings) {
    PaperResult result;
    std::vector<PaperList> lists = run_slaves(boxes, settings, result.seconds);

    auto start = Clock::now();
    lists = merge_on_machines(std::move(lists), settings.machines);
    result.seconds.merge_machine = seconds_since(start);
    start = Clock::now();
    const PaperList entries = merge_paper_lists(std::move(lists));
    result.seconds.merge_master = seconds_since(start);
    result.entries = entries.size();

    start = Clock::now();
    result.pairs = scan_paper_list(entries, boxes, result.candidates);
    result.seconds.scan = seconds_since(start);
    return result;
}

}  // namespace octopair::baselines
