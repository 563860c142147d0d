#include "engine/threads/thread_passes.hpp"

#include "base/timed.hpp"
#include "engine/threads/ascending.hpp"
#include "engine/threads/writers.hpp"

namespace octopair {

void ThreadPasses::scan_into(Call& call, Executor& executor, double progress) {
    scan_into(call, octree_, executor, progress);
}

void ThreadPasses::scan_into(Call& call, const OctreeRange& octants, Executor& executor, double progress) {
    const Timed timed(call.summary.steps.scan);
    call.progress.stage(progress, octants.octree.entry_count(octants.begin, octants.end));
    const ScanContext context{searched(call), call.stop.get_token(), scan_memory_};
    scan(octants, context, executor, [&](std::uint64_t entries) { call.progress.add(entries); });
}

std::uint64_t ThreadPasses::count(Call& call, double progress) {
    CountExecutor executor(team_);
    scan_into(call, executor, progress);
    return executor.pairs();
}

void ThreadPasses::count_by_object(Call& call, std::span<std::uint32_t> counts, double progress) {
    CountByObjectExecutor executor(team_, counts);
    scan_into(call, executor, progress);
}

void ThreadPasses::list_octal(Call& call, detail::PairStorage& list, double progress) {
    ListExecutor executor(team_, list);
    scan_into(call, executor, progress);
}

void ThreadPasses::stream_octal(Call& call, const Deliver& deliver, double progress) {
    StreamExecutor executor(team_, deliver, call.buffer_pairs(), call.stop);
    scan_into(call, executor, progress);
}

void ThreadPasses::list_ascending(Call& call, detail::PairStorage& list, const AscendingBounds& bounds,
                                  double progress) {
    AscendingExecutor executor(team_, list, bounds);
    const double begin = call.progress.end();
    scan_into(call, executor, begin + ascending_scan_part * (progress - begin));
    const Timed timed(call.summary.steps.scan);
    call.progress.stage(progress, executor.pairs());
    executor.append_sorted(call.stop.get_token(), [&](std::uint64_t pairs) { call.progress.add(pairs); });
}

}  // namespace octopair
