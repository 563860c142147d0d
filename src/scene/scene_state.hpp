// Scene::State: the implementation of Scene. Its parts:
//
//   objects    current objects, and the previous states of objects that changed since the last step
//   states     which state of the objects both octrees and the pairs describe: that of now, of the last step, or another
//   octree     mutable octree, for incremental steps and queries
//   search     incremental step: brings `octree` up to date and finds the pairs that began and ended
//   linear     linear octree of a full step. The first step with few changes after it builds `octree` from it
//   history    pairs of the last step; with slack, those of the searched boxes
//   exact      with slack: pairs of the objects' own boxes at the last step
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "base/tuning.hpp"
#include "octopair/scene.hpp"
#include "octopair/summary.hpp"
#include "octree/build/linear_octree.hpp"
#include "octree/dynamic/mutable_octree.hpp"
#include "octree/scan/scan.hpp"
#include "parallel/team.hpp"
#include "scene/change_search.hpp"
#include "scene/exact_pairs.hpp"
#include "scene/pair_history.hpp"
#include "scene/queries/scene_queries.hpp"
#include "scene/recording/recorder.hpp"
#include "scene/scene_box_source.hpp"
#include "scene/scene_objects.hpp"
#include "scene/searched_states.hpp"

namespace octopair {

class Scene::State {
public:
    /// Throws: Error{bad_input} if options are invalid; Error{io_failed} if the recording cannot be created.
    explicit State(const SceneOptions& options);

    /// Returns the objects for a call that changes them.
    SceneObjects& objects_to_change() {
        states_.change();
        return objects_;
    }
    const SceneObjects& objects() const { return objects_; }
    const StepResult& step(const std::stop_token& stop);
    const PairList& pairs() { return shown().list(); }
    const PairList& searched_pairs() { return history_.list(); }
    const PairList& persisting();
    SceneQueries& queries() { return queries_; }
    /// Returns the view of the current objects that queries read. Builds an octree unless there is one of the current objects, or one
    /// of the last step together with a log of the changes since.
    SceneQueries::View view(std::uint32_t groups, const std::stop_token& stop);
    /// Compares the pairs of the last step with a second algorithm (scene_verify.cpp).
    Verification verify(const std::stop_token& stop);
    /// Lists the octants of the objects' own boxes (scene_octants.cpp).
    Octants octants(const std::stop_token& stop);

private:
    // Defined in scene_step.cpp.
    std::function<void(std::uint64_t)> room_of(const SceneOptions& options);
    /// Returns the history of the pairs that the caller sees: with slack, the pairs of the own boxes.
    PairHistory& shown() { return exact_ ? exact_->history() : history_; }
    bool search(const std::stop_token& stop);
    void update_searched();
    bool find_nothing(const std::stop_token& stop);
    bool expects_few_changes() const;
    void find_all(const std::stop_token& stop);
    void build(const SceneBoxSource& source, const std::stop_token& stop);
    void build_octree_of_last_step(const std::stop_token& stop);
    bool find_changes(const std::stop_token& stop);

    double margin_;
    SceneObjects objects_;

    Team team_;
    ChangeSearch search_;
    SceneQueries queries_;
    LinearOctree linear_;
    ScanMemoryPool scan_memory_;
    MutableOctree octree_;
    /// Number of refills of linear_ since its octants were chosen. At the maximum, the next build chooses them anew.
    unsigned refills_ = tuning().scene.max_refills;
    unsigned steps_with_few_ = 0;  // number of consecutive searches in which few searched boxes had changed
    EntryRounding rounding_;
    SearchedStates states_;        // which states linear_, octree_ and history_ describe
    bool queried_ = false;         // a query has built octree_ since the last full step, so its memory is kept
    double full_seconds_ = 0;      // time of the last full step
    double seconds_a_change_ = 0;  // estimated time of an incremental step for each changed object

    PairHistory history_;
    std::optional<ExactPairs> exact_;  // only with slack
    PairChanges changes_;              // changes of the last step
    PairChanges found_;                // changes of the step under way, which may still fail
    PairList persisting_;
    StepResult result_;
    std::unique_ptr<Recorder> recorder_;  // null: calls are not recorded
};

}  // namespace octopair
