// Scene::State: what is behind a Scene, and how its parts work together.
//
//   table      the objects as they are now
//   log        what those that changed since the last step were before
//   octree     the objects as they were at the last step (`planted_`), or as they are now (`fresh_`)
//   search     brings a planted octree up to date, and tells which pairs began and ended
//   linear     for a step that searches all: where too much has changed, or there is no planted octree
//   history    the pairs of the last step
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "octopair/scene.hpp"
#include "octree/linear_octree.hpp"
#include "octree/mutable_octree.hpp"
#include "parallel/team.hpp"
#include "scene/change_log.hpp"
#include "scene/change_search.hpp"
#include "scene/object_table.hpp"
#include "scene/pair_history.hpp"
#include "scene/recorder.hpp"
#include "scene/scene_queries.hpp"
#include "scene/scene_source.hpp"

namespace octopair {

class Scene::State {
public:
    /// Throws Error{bad_input}, or Error{io_failed} for the recording.
    explicit State(const SceneOptions& options);

    void add(const Objects& objects, std::span<ObjectId> ids, std::span<const Traits> traits);
    void move(std::span<const ObjectId> ids, const Boxes& boxes, bool swept);
    void remove(std::span<const ObjectId> ids);
    void set_traits(std::span<const ObjectId> ids, std::span<const Traits> traits);
    const StepResult& step(const std::stop_token& stop);
    const PairList& pairs() { return history_.list(); }
    const PairList& persisting();
    const ObjectTable& table() const { return table_; }
    SceneQueries& queries() { return queries_; }
    /// For queries about the objects as they are now.
    SceneQueries::Scene view(std::uint32_t groups);

private:
    /// An object that is swept until the next step, and where it is then.
    struct Swept {
        ObjectId id;
        Box3d place;
    };

    // scene_state.cpp: the calls that change objects.
    void check_boxes(const Boxes& boxes, std::size_t expected) const;
    void check_ids(std::span<const ObjectId> ids) const;
    void check_paddings(std::span<const double> paddings, std::size_t objects) const;
    void check_removal(std::span<const ObjectId> ids);
    void prepare(std::uint64_t changes);
    template <typename Real>
    void add_all(std::span<const Box<Real>> boxes, std::span<const double> paddings, std::span<const Traits> traits,
                 std::span<ObjectId> ids);
    template <typename Real>
    void move_to(std::span<const ObjectId> ids, std::span<const Box<Real>> boxes);
    template <typename Real>
    void sweep_to(std::span<const ObjectId> ids, std::span<const Box<Real>> boxes);
    void drop_swept(std::uint32_t index);
    void settle_swept();

    // scene_step.cpp: the octrees, and what they find.
    void find_all(const std::stop_token& stop);
    void build(const SceneSource& source, const std::stop_token& stop);
    bool find_changes(const std::stop_token& stop);
    void finish_step();

    static constexpr unsigned most_refills = 8;

    double margin_;
    bool float64_;
    ObjectTable table_;
    ChangeLog log_;
    std::vector<std::uint32_t> removed_;  // since the last step
    std::vector<ObjectId> sorted_;        // of a call
    std::vector<Swept> swept_;
    std::vector<std::uint32_t> swept_at_;  // of an index in swept_, or none; empty before the first
    std::uint64_t moved_ = 0;              // objects, or calls for them, since the last step, beside those added

    Team team_;
    ChangeSearch search_;
    SceneQueries queries_;
    LinearOctree linear_;
    MutableOctree octree_;
    unsigned refills_ = most_refills;  // of the octants of linear_ since they were made; at most as many
    EntryRounding rounding_;
    bool planted_ = false;  // octree_ holds the objects as they were at the last step
    bool fresh_ = false;    // octree_ holds them as they are now
    bool built_ = false;    // linear_ does
    bool asked_ = false;    // queries made an octree since all was last searched: they may again
    double full_seconds_ = 0;
    double seconds_a_change_ = 0;

    PairHistory history_;
    PairChanges changes_;
    PairList persisting_;
    StepResult result_;
    std::unique_ptr<Recorder> recorder_;  // null: none. Told of each call between the checks and the first change
};

}  // namespace octopair
