#include "verification/shapes/stage_check.hpp"

#include <algorithm>
#include <mutex>
#include <utility>

#include "base/stop.hpp"
#include "parallel/team.hpp"
#include "verification/row_pass.hpp"

namespace octopair {

void StageCheck::take(std::span<const Pair> pairs, std::span<const Finding> findings) {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        // Undecided pairs are no collisions.
        if (findings[i].collision_class != CollisionClass::undecided) collisions_.push_back({pairs[i], findings[i]});
    }
}

/// Returns the collision of a pair; null: it was dropped. Requires: the collisions are sorted.
const Finding* StageCheck::finding_of(Pair pair) const {
    const auto at = std::ranges::lower_bound(collisions_, pair, {}, &Collision::pair);
    return at != collisions_.end() && at->pair == pair ? &at->finding : nullptr;
}

/// Judges a pair of boxes. Returns a text for users that describes its fault; empty if there is no fault.
std::string StageCheck::judge(Pair pair, std::set<std::string>& not_checked) const {
    const Finding* const finding = finding_of(pair);
    if (std::ranges::binary_search(excluded_, pair)) return finding != nullptr ? "it is excluded" : "";
    const auto object = [](const ShapedObjects& objects, std::uint32_t index) -> JudgedObject {
        return {objects.geometries[objects.geometry[index]], objects.poses[index],
                objects.padding.empty() ? 0 : objects.padding[index]};
    };
    const ShapedObjects& others = setup_.second != nullptr ? *setup_.second : setup_.first;
    const PairVerdict verdict =
        judge_pair({object(setup_.first, pair.a), object(others, pair.b)}, setup_.rules, finding, setup_.stop);
    if (verdict.not_checked != nullptr) not_checked.insert(verdict.not_checked);
    return verdict.fault;
}

/// Checks that each collision is a pair of boxes, once.
void StageCheck::check_collisions(const RowSearch& rows) const {
    const auto twice = std::ranges::adjacent_find(collisions_, {}, &Collision::pair);
    if (twice != collisions_.end())
        throw_verification_failed(name_of_pair(twice->pair) + " is twice among the collisions");
    for (const Collision& one : collisions_) {
        if (has_position(rows, one.pair) && rows.is_pair(one.pair.a, one.pair.b)) continue;
        throw_verification_failed(name_of_pair(one.pair) + " is a collision, but not a pair of boxes");
    }
}

bool StageCheck::has_motion() const {
    return !setup_.first.end_poses.empty() || (setup_.second != nullptr && !setup_.second->end_poses.empty());
}

StageCheck::Result StageCheck::finish() {
    std::ranges::sort(collisions_, {}, &Collision::pair);
    std::ranges::sort(excluded_);
    Team team(setup_.threads);
    const RowSearch rows(setup_.boxes, team, setup_.stop);
    check_collisions(rows);
    if (has_motion()) return {false, {"collisions of moving objects"}};
    const ProgressSink no_progress;
    const RowPass pass(rows, team, setup_.stop, no_progress);
    std::mutex mutex;
    Result result;
    // A certificate takes microseconds to seconds, so threads take few rows at a time.
    const RowRange all{.end = rows.rows(), .block = 4};
    const ResultFault fault = pass.run(all, Columns::ascending, [&](std::uint32_t a, auto columns) {
        std::set<std::string> reasons;
        ResultFault wrong;
        for (auto b = columns.begin(); b != columns.end() && !wrong; ++b) {
            throw_if_stopped(setup_.stop);
            const std::string text = judge({a, *b}, reasons);
            if (!text.empty()) wrong = name_of_pair({a, *b}) + ": " + text;
        }
        const std::lock_guard lock(mutex);
        result.not_checked.merge(reasons);
        return wrong;
    });
    if (fault) throw_verification_failed(*fault);
    return result;
}

}  // namespace octopair
