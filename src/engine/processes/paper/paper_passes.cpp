#include "engine/processes/paper/paper_passes.hpp"

#include <algorithm>
#include <utility>

#include "octopair/error.hpp"

namespace octopair {

void PaperPasses::build(Call& call, double progress) {
    call.progress.stage(progress, 1);
    if (arena_ == nullptr) arena_ = pool_.add_region(SharedMemory::create(max_region_bytes()));
    std::vector<std::shared_ptr<Region>> regions = {arena_};
    Pass pass;
    inputs_.place(call, pool_, pass, regions);
    pass.job = pool_.begin_job();
    pass.kind = PassKind::lists;
    pass.workers = pool_.workers();
    pass.margin = call.request.options.margin;
    pass.arena_region = arena_->number;
    PassWatch watch;
    watch.stop = call.stop.get_token();
    try {
        (void)pool_.run(pass, regions, watch);
        OctreeLayout layout = make_layout(call.source, watch.stop);
        const auto lists = find_lists(pass.workers, {call.source.size(), layout.directory.octants().size()});
        octree().assemble(std::move(layout), lists, watch.stop);
    } catch (const LinearOctree::Invalid& invalid) {
        call.source.refuse(invalid.begin);
    }
    call.summary.entries = octree().entry_count();
    call.summary.steps.merge = octree().seconds().merge;
    for (unsigned slot = 0; slot < pass.workers; ++slot) {
        call.summary.steps.encode = std::max(call.summary.steps.encode, pool_.view().slot(slot).encode_seconds);
    }
}

std::vector<SortedList> PaperPasses::find_lists(std::size_t count, const ListBounds& bounds) const {
    std::vector<SortedList> lists;
    for (const Share& share : pool_.view().shares(0, count)) {
        if (!ShareState::of(share.state.load()).is(pool_.number(), ShareStatus::done)) {
            throw Error(ErrorCode::engine_failed, "shared memory: the sorted list of a worker is missing");
        }
        lists.push_back(find_list(arena_->memory, share.first_run, bounds));
    }
    return lists;
}

}  // namespace octopair
