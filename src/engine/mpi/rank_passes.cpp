#include "engine/mpi/rank_passes.hpp"

#include "engine/writers.hpp"

namespace octopair {

void RankPasses::build(Call& call, double progress) {
    call.progress.stage(progress, 1);
    TeamExecutor threads(team());
    RankExecutor executor(threads, *stops_);
    octree().build(std::move(share_.octants), call.source, executor, call.stop.get_token());
    call.summary.entries = octree().entry_count(share_.begin, share_.end);
    call.summary.steps.encode = octree().seconds().encode;
    call.summary.steps.merge = octree().seconds().merge;
    call.summary.steps.sort = octree().seconds().sort;
}

void RankPasses::scan_into(Call& call, Executor& executor, double progress) {
    RankExecutor numbering(executor, *stops_, share_.numbers);
    ThreadPasses::scan_into(call, {octree(), share_.begin, share_.end}, numbering, progress);
}

}  // namespace octopair
