#include "engine/processes/client/process_passes.hpp"

#include <algorithm>
#include <utility>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "engine/processes/client/ring_reader.hpp"
#include "octopair/error.hpp"
#include "octree/build/linear_octree.hpp"

namespace octopair {

namespace {

[[noreturn]] void throw_damaged_result() {
    throw Error(ErrorCode::engine_failed, "shared memory: the results of the worker processes are damaged");
}

}  // namespace

ProcessPasses::ProcessPasses(WorkerPool& pool, const SharedArrays& arrays) : pool_(pool), inputs_(arrays) {}

void ProcessPasses::build(Call& call, double) {
    if (arena_ == nullptr) arena_ = pool_.add_region(SharedMemory::create(max_region_bytes()));
    regions_ = {arena_};
    pass_ = {};
    inputs_.place(call, pool_, pass_, regions_);
    pass_.job = pool_.begin_job();
    pass_.workers = unsigned(
        std::clamp<std::uint64_t>(call.source.size() / tuning().processes.objects_per_worker, 1, pool_.workers()));
    pass_.margin = call.request.options.margin;
    pass_.arena_region = arena_->number;
}

/// Runs `pass_` on the workers, which write their pairs to the region `pairs`.
void ProcessPasses::run(Call& call, double progress, const std::shared_ptr<Region>& pairs, PassWatch watch) {
    pass_.pairs_region = pairs->number;
    std::vector<std::shared_ptr<Region>> needed = regions_;
    needed.push_back(pairs);
    const double begin = call.progress.end();
    const double scan_part = pass_.kind == PassKind::list_ascending ? ascending_scan_part : 1;
    // The progress of this stage includes the steps before the scan.
    call.progress.stage(begin + scan_part * (progress - begin), call.source.size() * 5 / 4);
    PassProgress shown{.end = progress};
    watch.stop = call.stop.get_token();
    watch.poll = [&, poll = std::move(watch.poll)] {
        show_progress(call, shown);
        if (poll) poll();
    };
    try {
        (void)pool_.run(pass_, needed, watch);
    } catch (const LinearOctree::Invalid& invalid) {
        call.source.refuse(std::min(invalid.begin, std::size_t(call.source.size())));
    } catch (const OverBudget&) {
        pass_.built = 1;
        throw;
    }
    take_results(call);
    pass_.built = 1;
}

void ProcessPasses::show_progress(Call& call, PassProgress& shown) {
    std::uint64_t scanned = 0, to_order = 0, ordered = 0;
    for (unsigned i = 0; i < pass_.workers; ++i) {
        const Slot& slot = pool_.view().slot(i);
        const std::uint64_t own = slot.entries_scanned.load();
        scanned += own;
        if (own > 0 && !std::exchange(shown.scanning, true)) call.progress.set_work(slot.entries);
        to_order = std::max(to_order, slot.pairs_to_order.load());
        ordered += slot.pairs_ordered.load();
    }
    if (to_order > 0 && !shown.ordering) {
        call.progress.stage(shown.end, to_order);
        shown = {shown.end, true, true, 0};
    }
    const std::uint64_t done = shown.ordering ? ordered : scanned;
    if (done > shown.done) call.progress.add(done - std::exchange(shown.done, done));
}

/// Adds the times of the slowest worker to the summary, because each step lasts until all workers have finished it.
void ProcessPasses::take_results(Call& call) {
    StepSeconds steps;
    for (unsigned i = 0; i < pass_.workers; ++i) {
        const Slot& slot = pool_.view().slot(i);
        steps.encode = std::max(steps.encode, slot.encode_seconds);
        steps.scatter = std::max(steps.scatter, slot.scatter_seconds);
        steps.count = std::max(steps.count, slot.count_seconds);
        steps.scan = std::max(steps.scan, slot.scan_seconds);
        call.summary.entries = slot.entries;
    }
    if (pass_.built == 0) {
        call.summary.steps.encode = steps.encode;
        call.summary.steps.scatter = steps.scatter;
        call.summary.steps.count = steps.count;
    }
    call.summary.steps.scan += steps.scan;
}

std::span<Share> ProcessPasses::shares_done() {
    const auto shares = pool_.view().shares(0, pool_.shares());
    for (const Share& share : shares) {
        if (!ShareState::of(share.state.load()).is(pool_.number(), ShareStatus::done)) throw_damaged_result();
    }
    return shares;
}

/// Returns a region for pairs that no list holds. Creates one if necessary.
std::shared_ptr<Region> ProcessPasses::free_pairs() {
    auto found = std::find_if(pairs_.begin(), pairs_.end(), [](const auto& region) { return region.use_count() == 1; });
    if (found == pairs_.end()) {
        pairs_.push_back(pool_.add_region(SharedMemory::create(max_region_bytes())));
        found = pairs_.end() - 1;
    }
    return *found;
}

PairCount ProcessPasses::count(Call& call, double progress, const CountLimit& limit) {
    struct CountedEnough {};
    pass_.kind = PassKind::count;
    std::uint64_t all = 0, counted = 0;  // `all`: the pairs of the first `counted` shares
    PassWatch watch;
    watch.poll = [&] {
        while (counted < max_shares) {
            const Share& share = pool_.view().shares(counted, 1).front();
            if (!ShareState::of(share.state.load()).is(pool_.number(), ShareStatus::done)) break;
            all += share.pairs;
            ++counted;
        }
        if (limit.reached(all)) throw CountedEnough{};
    };
    try {
        run(call, progress, free_pairs(), std::move(watch));
    } catch (const CountedEnough&) {
        return {all - 1, false};
    }
    all = 0;
    for (const Share& share : shares_done()) all += share.pairs;
    return {all};
}

/// Runs `pass_`, which fills a list. If it is the list of the call, `call.room` watches the memory `pairs`.
// NOLINTNEXTLINE(readability-function-size): the parameters of run(), and the list.
void ProcessPasses::run_list(Call& call, double progress, const detail::PairStorage& list,
                             const std::shared_ptr<Region>& pairs) {
    const bool watched = call.output.list != nullptr && &detail::storage_of(*call.output.list) == &list;
    if (!watched || call.room == nullptr) return run(call, progress, pairs, {});
    try {
        PassWatch watch;
        watch.poll = [&, growing = true]() mutable { growing = growing && check_growth(call, pairs->memory); };
        run(call, progress, pairs, std::move(watch));
    } catch (const Error& error) {
        // The workers may fill all memory before the client looks at it.
        const bool found_pairs = pool_.view().control_block().next_block.load() > 0;
        if (error.code() != ErrorCode::resource_limit || !found_pairs || !call.room->can_count()) throw;
        call.room->hold(pairs->memory.committed_bytes(), pairs->memory.size());
        pass_.built = 1;
        throw OverBudget{};
    }
}

/// Returns false when the number of pairs is known because the workers sort them. Throws: as PairRoom::check() and require().
bool ProcessPasses::check_growth(Call& call, const SharedMemory& pairs) {
    call.room->hold(pairs.committed_bytes(), pairs.size());
    for (unsigned i = 0; i < pass_.workers; ++i) {
        if (const std::uint64_t all = pool_.view().slot(i).pairs_to_order.load(); all > 0) {
            call.room->require({all});
            return false;
        }
    }
    const std::uint64_t found = pool_.view().control_block().next_block.load() * list_block_pairs;
    if (found >= tuning().output.unchecked_bytes / sizeof(Pair)) call.room->check(found);
    return true;
}

/// Repeats the whole pass when a worker is lost. The lost share alone cannot be repeated, because the lost worker may already have added
/// a part of it to the counts.
void ProcessPasses::count_by_object(Call& call, std::span<std::uint32_t> counts, double progress) {
    struct Again {};
    pass_.kind = PassKind::count_by_object;
    const auto pairs = free_pairs();
    for (bool again = true; again;) {
        try {
            PassWatch watch;
            watch.on_worker_lost = [](unsigned) { throw Again{}; };
            run(call, progress, pairs, std::move(watch));
            again = false;
        } catch (const Again&) {
        }
    }
    const std::uint64_t place = pool_.view().slot(0).number;
    if (place % alignof(std::uint32_t) != 0) throw_damaged_result();
    std::copy_n(arena_->memory.array<std::uint32_t>(place, counts.size()), counts.size(), counts.begin());
}

void ProcessPasses::list_octal(Call& call, detail::PairStorage& list, double progress) {
    pass_.kind = PassKind::list_octal;
    const auto pairs = free_pairs();
    run_list(call, progress, list, pairs);
    append_runs(list, pairs);
}

void ProcessPasses::list_ascending(Call& call, detail::PairStorage& list, const AscendingBounds& bounds,
                                   double progress) {
    pass_.kind = PassKind::list_ascending;
    pass_.bounds = bounds;
    const auto pairs = free_pairs();
    run_list(call, progress, list, pairs);
    append_runs(list, pairs);
}

/// Appends the runs of all shares. The list keeps the memory that the workers wrote to, or gets a copy.
void ProcessPasses::append_runs(detail::PairStorage& list, const std::shared_ptr<Region>& pairs) {
    const ControlBlockView& view = pool_.view();
    const std::uint64_t written = view.control_block().next_block.load();
    if (written > pairs->memory.size() / (list_block_pairs * sizeof(Pair))) throw_damaged_result();
    const std::span<const Pair> all{pairs->memory.array<const Pair>(0, written * list_block_pairs),
                                    std::size_t(written * list_block_pairs)};
    std::vector<std::span<const Pair>> runs;
    std::uint64_t size = 0;
    for (const Share& share : shares_done()) {
        for (const Run& run : view.runs(share.first_run, share.runs)) {
            if (run.begin > all.size() || run.count > all.size() - run.begin) throw_damaged_result();
            runs.push_back(all.subspan(run.begin, run.count));
            size += run.count;
        }
    }
    const bool keep = size >= tuning().processes.worth_keeping && pairs_.size() <= tuning().processes.kept_regions;
    count_path(keep ? Path::region_kept : Path::region_copied);
    if (keep) list.keep(pairs);
    for (const auto run : runs) list.append(keep ? run : list.copy(run));
}

void ProcessPasses::stream_octal(Call& call, const PairSink& deliver, double progress) {
    pass_.kind = PassKind::stream_octal;
    const auto pairs = free_pairs();
    const RingSize size = ring_size(call.buffer_pairs(), pass_.workers);
    pass_.ring_blocks = size.blocks;
    pass_.block_pairs = size.block_pairs;
    RingReader reader(pool_, pairs->memory, pass_, deliver);
    PassWatch watch;
    watch.poll = [&] { (void)reader.take(); };
    watch.on_worker_lost = [&](unsigned slot) { reader.forget_unfinished(slot); };
    run(call, progress, pairs, std::move(watch));
    while (reader.take()) throw_if_stopped(call.stop.get_token());
    if (!reader.complete(pool_.shares())) throw_damaged_result();
}

}  // namespace octopair
