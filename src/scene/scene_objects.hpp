// SceneObjects: the objects of a scene, and the calls that change them: checked as a whole, recorded, then made.
//
// A call that fails changes nothing. The same calls give the same ids, wherever they are made.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octopair/scene.hpp"
#include "scene/change_log.hpp"
#include "scene/object_table.hpp"
#include "scene/recording/call_encoder.hpp"

namespace octopair {

class SceneObjects {
public:
    /// Whether what objects were before they changed is kept until the step.
    enum class Changes : std::uint8_t { kept, forgotten };
    /// An object that is swept until the next step, and where it is then.
    struct Swept {
        ObjectId id;  ///< of none if it was moved or removed since
        Box3d place;
    };

    /// Throws Error{bad_input} for options that no scene has.
    explicit SceneObjects(const SceneOptions& options, Changes changes = Changes::kept);
    /// Told of each call between the checks and the first change; null: nobody is.
    void record_to(CallEncoder* recorder) { recorder_ = recorder; }

    void add(const Objects& objects, std::span<ObjectId> ids, std::span<const Traits> traits);
    void move(std::span<const ObjectId> ids, const Boxes& boxes, bool swept);
    void remove(std::span<const ObjectId> ids);
    void set_traits(std::span<const ObjectId> ids, std::span<const Traits> traits);
    /// A step was made: removed objects' indices are free, and what was swept is where it came to.
    void finish_step();

    const ObjectTable& table() const { return table_; }
    const ChangeLog& log() const { return log_; }
    /// Objects, or calls for them, since the last step, beside those added.
    std::uint64_t moved() const { return moved_; }
    /// Indices, since the last step.
    std::span<const std::uint32_t> removed() const { return removed_; }
    std::span<const Swept> swept() const { return swept_; }
    /// Error{bad_input} if there is none.
    ObjectId id(std::uint32_t index) const;

private:
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

    bool float64_;
    ObjectTable table_;
    ChangeLog log_;
    Changes changes_;
    std::vector<std::uint32_t> removed_;  // since the last step
    std::vector<ObjectId> sorted_;        // of a call
    std::vector<Swept> swept_;
    std::vector<std::uint32_t> swept_at_;  // of an index in swept_, or none; empty before the first
    std::uint64_t moved_ = 0;
    CallEncoder* recorder_ = nullptr;
};

}  // namespace octopair
