// ObjectTable: boxes, paddings, traits and generations of a scene's objects, by index.
//
// Invariants
//   An index is in use ("alive") if its generation is odd.
//   Boxes are stored in one precision, that of the scene.
//   Paddings and traits have arrays only from the first object on that does not have the default value.
//   The box at an index that is not in use is valid, but has no meaning.
//   An object has its own box and a box that is searched. Without slack these are the same. With slack the searched box is enlarged. It
//   contains the own box after enlarge() or enlarge_all(), and does not change when the object moves.
#pragma once

#include <hwy/cache_control.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <type_traits>
#include <variant>
#include <vector>

#include "base/growing_array.hpp"
#include "base/private_export.hpp"
#include "boxes/box_kernel.hpp"
#include "octopair/objects.hpp"
#include "octopair/scene.hpp"

namespace octopair {

/// State of an object at one time.
struct ObjectState {
    bool exists;
    Box3d box;
    double padding;
    Traits traits;
};

class OCTOPAIR_PRIVATE_EXPORT ObjectTable {
public:
    /// `slack`: as in SceneOptions.
    explicit ObjectTable(Precision precision, double slack = 0) : precision_(precision), slack_(slack) {}

    static constexpr std::uint32_t none = ~std::uint32_t(0);

    std::uint64_t size() const { return size_; }
    std::uint64_t indices() const { return slots_.size(); }
    bool alive(std::uint32_t index) const { return (slots_[index].generation & 1) != 0; }
    bool contains(ObjectId id) const {
        return id.index < slots_.size() && slots_[id.index].generation == id.generation && alive(id.index);
    }
    ObjectId id(std::uint32_t index) const { return {index, slots_[index].generation}; }

    bool has_slack() const { return slack_ > 0; }
    /// Returns the object's own box.
    Box3d box(std::uint32_t index) const { return (has_slack() ? own_ : searched_).box(index); }
    Box3d searched_box(std::uint32_t index) const { return searched_.box(index); }
    /// Returns whether `box` is the object's own box.
    template <typename Real>
    bool has_box(std::uint32_t index, const Box<Real>& box) const {
        return equal((has_slack() ? own_ : searched_).template all<Real>()[index], box);
    }
    double padding(std::uint32_t index) const { return padded_ ? paddings_[index] : 0; }
    Traits traits(std::uint32_t index) const { return with_traits_ ? traits_[index] : Traits{}; }
    /// Returns the state that a search uses, with the searched box.
    ObjectState state(std::uint32_t index) const {
        return {alive(index), searched_box(index), padding(index), traits(index)};
    }
    bool any_padding() const { return padded_; }
    bool any_traits() const { return with_traits_; }
    /// Returns searched boxes and paddings of all indices, including indices that are not in use.
    Objects objects() const { return {boxes_of(searched_), paddings_.span()}; }
    /// Returns own boxes and paddings of all indices, including indices that are not in use.
    Objects own_objects() const { return {boxes_of(has_slack() ? own_ : searched_), paddings_.span()}; }
    /// Returns the own boxes of all indices. Requires: has_slack(); the table has the precision of Real.
    template <typename Real>
    std::span<const Box<Real>> own_boxes() const {
        return own_.template all<Real>().span();
    }
    Precision precision() const { return precision_; }
    /// Returns the traits of all indices; empty if all objects have the defaults.
    std::span<const Traits> all_traits() const { return with_traits_ ? traits_.span() : std::span<const Traits>(); }
    /// Returns the indices that are free. create() uses the last element first.
    std::span<const std::uint32_t> free() const { return free_; }
    /// Prefetches the data that other functions read of this object.
    void prefetch(std::uint32_t index) const {
        prefetch_slot(index);
        searched_.prefetch(index);
        if (has_slack()) own_.prefetch(index);
    }
    /// Prefetches what contains() reads. `index` may be out of range.
    void prefetch_slot(std::uint32_t index) const {
        if (index < slots_.size()) hwy::Prefetch(&slots_[index]);
    }

    /// Adds an object at a free index, or at a new index if no index is free. Returns the object's id.
    /// Requires: reserve() has been called for it.
    template <typename Real>
    ObjectId create(const Box<Real>& box, double padding, const Traits& traits);
    /// Sets the object's own box. Requires: the table's precision represents `box` exactly.
    template <typename Real>
    void set_box(std::uint32_t index, const Box<Real>& box) {
        (has_slack() ? own_ : searched_).set(index, box);
    }
    /// Stores the indices of objects whose own boxes are not within their searched boxes in `outside`. Requires: has_slack().
    void find_outside(std::vector<std::uint32_t>& outside) const;
    /// Sets the searched box to the own box, enlarged by the slack. Requires: has_slack().
    void enlarge(std::uint32_t index);
    void enlarge_all();
    /// Requires: reserve() has been called with `with_traits`, unless `traits` are the defaults.
    void set_traits(std::uint32_t index, const Traits& traits) {
        if (with_traits_) traits_[index] = traits;
    }
    /// Removes an object. Its index becomes free with release().
    void kill(std::uint32_t index) {
        ++slots_[index].generation;
        --size_;
    }
    void release(std::uint32_t index) { free_.push_back(index); }
    /// Reserves memory for `more` calls of release().
    void reserve_release(std::size_t more) { reserve_more(free_, more); }
    /// Reserves memory for `more` objects. `with_padding`, `with_traits`: also creates the array, if there is none yet.
    void reserve(std::uint64_t more, bool with_padding, bool with_traits);

    /// Position of the object in the change log (change_log.hpp); initially `none`.
    std::uint32_t mark(std::uint32_t index) const { return slots_[index].mark; }
    void set_mark(std::uint32_t index, std::uint32_t mark) { slots_[index].mark = mark; }

private:
    struct Slot {
        std::uint32_t generation;  ///< odd: the object is alive
        std::uint32_t mark;
    };

    /// Boxes by index, in one of two precisions.
    struct BoxArray {
        GrowingArray<Box3f> float32;
        GrowingArray<Box3d> float64;

        template <typename Real>
        const GrowingArray<Box<Real>>& all() const {
            if constexpr (std::is_same_v<Real, float>)
                return float32;
            else
                return float64;
        }
        Box3d box(std::uint32_t index) const { return float64.empty() ? wide(float32[index]) : float64[index]; }
        void prefetch(std::uint32_t index) const {
            float64.empty() ? hwy::Prefetch(&float32[index]) : hwy::Prefetch(&float64[index]);
        }
        void set(std::uint32_t index, const Box3f& box) { float32[index] = box; }
        void set(std::uint32_t index, const Box3d& box);
    };

    Boxes boxes_of(const BoxArray& boxes) const {
        if (precision_ == Precision::float64) return boxes.float64.span();
        return boxes.float32.span();
    }
    std::uint32_t new_index();
    template <typename Real>
    Box<Real> enlarged(const Box<Real>& box) const;
    template <typename Real>
    static bool equal(const Box<Real>& a, const Box<Real>& b) {
        return std::ranges::equal(a.min, b.min) && std::ranges::equal(a.max, b.max);
    }

    Precision precision_;
    double slack_;
    BoxArray searched_;
    BoxArray own_;  // empty without slack
    GrowingArray<Slot> slots_;
    bool padded_ = false, with_traits_ = false;
    GrowingArray<double> paddings_;  // empty unless padded_
    GrowingArray<Traits> traits_;    // empty unless with_traits_
    std::vector<std::uint32_t> free_;
    std::uint64_t size_ = 0;  // number of objects that are alive
};

template <typename Real>
ObjectId ObjectTable::create(const Box<Real>& box, double padding, const Traits& traits) {
    const std::uint32_t index = new_index();
    ++slots_[index].generation;
    ++size_;
    set_box(index, box);
    if (has_slack()) enlarge(index);
    if (padded_) paddings_[index] = padding;
    if (with_traits_) traits_[index] = traits;
    return id(index);
}

}  // namespace octopair
