#include "engine/mpi/paper/master_passes.hpp"

#include "engine/mpi/comm/cost_meter.hpp"

namespace octopair {

void MasterPasses::build(Call& call, double progress) {
    call.progress.stage(progress, 1);
    const Metered metered(comm_, costs_.merge);
    octree().assemble(std::move(layout_), lists_, call.stop.get_token());
    call.summary.entries = octree().entry_count();
    call.summary.steps.merge = octree().seconds().merge;
}

void MasterPasses::scan_into(Call& call, Executor& executor, double progress) {
    RankExecutor watching(executor, *stops_);
    ThreadPasses::scan_into(call, octree(), watching, progress);
}

}  // namespace octopair
