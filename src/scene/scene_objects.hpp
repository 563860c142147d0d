// SceneObjects: the objects of a scene and the calls that change them.
//
// Invariants
//   A call is checked as a whole, then recorded, then applied. A call that fails changes nothing.
//   Ids are a function of the calls alone: equal sequences of calls on two scenes return equal ids.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/private_export.hpp"
#include "octopair/scene.hpp"
#include "scene/change_log.hpp"
#include "scene/object_table.hpp"
#include "scene/recording/recording.hpp"

namespace octopair {

class OCTOPAIR_PRIVATE_EXPORT SceneObjects {
public:
    /// Whether the previous states of changed objects are logged until the next step.
    enum class Changes : std::uint8_t { kept, forgotten };
    /// An object that is swept. Until the next step ends, its box in the table contains its boxes at the begin and at the end of the sweep.
    struct Swept {
        ObjectId id;  ///< default-constructed if the object was moved or removed since
        Box3d place;  ///< box of the object after the next step
    };

    /// Throws: Error{bad_input} if options are invalid.
    explicit SceneObjects(const SceneOptions& options, Changes changes = Changes::kept);
    /// Sets the recorder, which receives each call after its checks and before its first change. Null: no recorder.
    void record_to(CallEncoder* recorder) { recorder_ = recorder; }

    void add(const Objects& objects, std::span<ObjectId> ids, std::span<const Traits> traits);
    void move(std::span<const ObjectId> ids, const Boxes& boxes, bool swept);
    void remove(std::span<const ObjectId> ids);
    void set_traits(std::span<const ObjectId> ids, std::span<const Traits> traits);
    /// With slack: enlarges and logs the searched boxes that moved objects have left. Must be called before a search.
    void update_searched();
    /// With slack: enlarges all searched boxes anew, and empties the log. The step must then search all objects.
    void enlarge_all();
    /// Ends a step: frees the indices of removed objects and sets swept objects to their new boxes. Returns true if boxes of
    /// objects have changed.
    bool finish_step();

    const ObjectTable& table() const { return table_; }
    const ChangeLog& log() const { return log_; }
    /// Returns whether any object was added or changed since the last step. An object that is moved to where it is does not
    /// change. A swept object changes when the step ends.
    bool changed() const { return is_changed_by_call_ || !settled_.empty(); }
    /// Returns whether a call has added or changed any object since the last step.
    bool is_changed_by_call() const { return is_changed_by_call_; }
    /// An object that was swept in the last step.
    struct Settled {
        std::uint32_t index;
        Box3d swept_box;  ///< own box of the object during the last step
    };
    std::span<const Settled> settled() const { return settled_; }
    /// Returns whether a change since the last step must be searched for. Without slack that is every change.
    /// Requires: update_searched() has been called.
    bool must_search() const {
        return table_.has_slack() ? log_.overflowed() || !log_.previous_states().empty() : changed();
    }
    /// Returns the indices of objects that were removed since the last step.
    std::span<const std::uint32_t> removed() const { return removed_; }
    std::span<const Swept> swept() const { return swept_; }
    /// Returns the id of the object at `index`. Throws: Error{bad_input} if there is no such object.
    ObjectId id(std::uint32_t index) const;

private:
    void check_boxes(const Boxes& boxes, std::size_t expected) const;
    void check_ids(std::span<const ObjectId> ids) const;
    void check_paddings(std::span<const double> paddings, std::size_t objects) const;
    void check_removal(std::span<const ObjectId> ids);
    void prepare(std::uint64_t changes);
    void note_move(std::uint32_t index);
    template <typename Real>
    void add_all(std::span<const Box<Real>> boxes, std::span<const double> paddings, std::span<const Traits> traits,
                 std::span<ObjectId> ids);
    template <typename Real>
    void move_to(std::span<const ObjectId> ids, std::span<const Box<Real>> boxes);
    template <typename Real>
    void sweep_to(std::span<const ObjectId> ids, std::span<const Box<Real>> boxes);
    void drop_swept(std::uint32_t index);
    /// Sets swept objects to their new boxes. Returns false if no object was swept.
    bool finish_sweeps();

    bool float64_;
    ObjectTable table_;
    ChangeLog log_;
    Changes changes_;
    std::vector<std::uint32_t> removed_;  // indices of objects removed since the last step
    std::vector<ObjectId> sorted_;        // buffer of check_removal()
    std::vector<std::uint32_t> outside_;  // buffer of update_searched()
    std::vector<Swept> swept_;
    /// By object index: position in swept_, or `none`. Empty before the first sweep.
    std::vector<std::uint32_t> swept_at_;
    std::vector<Settled> settled_;     // objects that were swept in the last step; has room for all of swept_
    bool is_changed_by_call_ = false;  // since the last step
    CallEncoder* recorder_ = nullptr;
};

}  // namespace octopair
