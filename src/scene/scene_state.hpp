// Scene::State: what is behind a Scene, and how its parts work together.
//
//   objects    as they are now, and what those that changed since the last step were before
//   octree     the objects as they were at the last step (`octree_is_current_`), or as they are now (`fresh_`)
//   search     brings a planted octree up to date, and tells which pairs began and ended
//   linear     for a step that searches all: where too much has changed, or there is no planted octree
//   history    the pairs of the last step
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "base/tuning.hpp"
#include "octopair/scene.hpp"
#include "octree/dynamic/mutable_octree.hpp"
#include "octree/linear_octree.hpp"
#include "parallel/team.hpp"
#include "scene/change_search.hpp"
#include "scene/pair_history.hpp"
#include "scene/queries/scene_queries.hpp"
#include "scene/recording/recorder.hpp"
#include "scene/scene_objects.hpp"
#include "scene/scene_source.hpp"

namespace octopair {

class Scene::State {
public:
    /// Throws Error{bad_input}, or Error{io_failed} for the recording.
    explicit State(const SceneOptions& options);

    /// For a call that changes them: octrees of the objects as they are now are none any more.
    SceneObjects& to_change() {
        fresh_ = built_ = false;
        return objects_;
    }
    const SceneObjects& objects() const { return objects_; }
    const StepResult& step(const std::stop_token& stop);
    const PairList& pairs() { return history_.list(); }
    const PairList& persisting();
    SceneQueries& queries() { return queries_; }
    /// For queries about the objects as they are now.
    SceneQueries::Scene view(std::uint32_t groups);

private:
    // scene_step.cpp: the octrees, and what they find.
    void find_all(const std::stop_token& stop);
    void build(const SceneSource& source, const std::stop_token& stop);
    bool find_changes(const std::stop_token& stop);
    void drop_octrees();

    double margin_;
    SceneObjects objects_;

    Team team_;
    ChangeSearch search_;
    SceneQueries queries_;
    LinearOctree linear_;
    MutableOctree octree_;
    unsigned refills_ = tuning().scene.refills;  // of the octants of linear_ since they were made; at most as many
    EntryRounding rounding_;
    bool octree_is_current_ = false;  // octree_ holds the objects as they were at the last step
    bool fresh_ = false;    // octree_ holds them as they are now
    bool built_ = false;    // linear_ does
    bool asked_ = false;    // queries made an octree since all was last searched: they may again
    double full_seconds_ = 0;
    double seconds_a_change_ = 0;

    PairHistory history_;
    PairChanges changes_;  // of the last step
    PairChanges found_;    // by one that may fail yet
    PairList persisting_;
    StepResult result_;
    std::unique_ptr<Recorder> recorder_;  // null: none
};

}  // namespace octopair
