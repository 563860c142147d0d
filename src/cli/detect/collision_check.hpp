// CollisionCheck: checks the collisions of one frame by certificates (--verify with an exact stage).
#pragma once

#include <memory>
#include <span>
#include <stop_token>

#include "cli/detect/filter_chain.hpp"
#include "verification/shapes/stage_check.hpp"

namespace octopair::cli {

class CollisionCheck {
public:
    /// Borrows all but the token.
    CollisionCheck(const DetectRequest& request, const SetPair& sets, std::uint64_t frame, std::stop_token stop);
    CollisionCheck(const CollisionCheck&) = delete;
    CollisionCheck& operator=(const CollisionCheck&) = delete;

    /// Takes the next collisions of the frame.
    void take(const Batch& batch) { check_->take(batch.pairs(), batch.findings()); }
    /// Checks all collisions of the frame. `excluded`: the pairs that exclusion rules leave out. Throws: as StageCheck::finish().
    StageCheck::Result finish(std::span<const Pair> excluded);

private:
    Objects first_boxes_, second_boxes_;
    ShapedObjects first_, second_;
    std::unique_ptr<StageCheck> check_;
};

}  // namespace octopair::cli
