#include "cli/detect/collision_check.hpp"

#include <utility>

#include "cli/detect/tolerance.hpp"
#include "cli/input/shaped_set.hpp"

namespace octopair::cli {

CollisionCheck::CollisionCheck(const DetectRequest& request, const SetPair& sets, std::uint64_t frame,
                               std::stop_token stop) {
    const bool join = sets.second != nullptr;
    first_boxes_ = sets.first.frame(frame);
    first_ = sets.first.shaped->objects(sets.first.padding);
    if (join) {
        second_boxes_ = sets.second->frame(frame);
        second_ = sets.second->shaped->objects(sets.second->padding);
    }
    const StageRules rules{request.margin, tolerance_of(request, sets), stage_of(request) == Stage::features,
                           request.pipeline.min_depth};
    check_ =
        std::make_unique<StageCheck>(StageCheck::Setup{{first_boxes_, join ? &second_boxes_ : nullptr, request.margin},
                                                       first_,
                                                       join ? &second_ : nullptr,
                                                       rules,
                                                       local_threads(request.engine),
                                                       std::move(stop)});
}

StageCheck::Result CollisionCheck::finish(std::span<const Pair> excluded) {
    check_->exclude(excluded);
    return check_->finish();
}

}  // namespace octopair::cli
