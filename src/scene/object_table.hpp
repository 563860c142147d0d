// ObjectTable: boxes, paddings, traits and generations of a scene's objects, by index.
//
// Invariants
//   An index is in use ("alive") if its generation is odd.
//   Boxes are stored in one precision, that of the scene.
//   Paddings and traits have arrays only from the first object on that does not have the default value.
//   The box at an index that is not in use is valid, but has no meaning.
#pragma once

#include <hwy/cache_control.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "base/growing_array.hpp"
#include "base/reserve.hpp"
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

class ObjectTable {
public:
    explicit ObjectTable(Precision precision);

    static constexpr std::uint32_t none = ~std::uint32_t(0);

    std::uint64_t size() const { return size_; }
    std::uint64_t indices() const { return slots_.size(); }
    bool alive(std::uint32_t index) const { return (slots_[index].generation & 1) != 0; }
    bool contains(ObjectId id) const {
        return id.index < slots_.size() && slots_[id.index].generation == id.generation && alive(id.index);
    }
    ObjectId id(std::uint32_t index) const { return {index, slots_[index].generation}; }

    Box3d box(std::uint32_t index) const { return boxes64_.empty() ? wide(boxes32_[index]) : boxes64_[index]; }
    bool has_box(std::uint32_t index, const Box3f& box) const { return equal(boxes32_[index], box); }
    bool has_box(std::uint32_t index, const Box3d& box) const { return equal(boxes64_[index], box); }
    double padding(std::uint32_t index) const { return padded_ ? paddings_[index] : 0; }
    Traits traits(std::uint32_t index) const { return with_traits_ ? traits_[index] : Traits{}; }
    ObjectState state(std::uint32_t index) const { return {alive(index), box(index), padding(index), traits(index)}; }
    bool any_padding() const { return padded_; }
    bool any_traits() const { return with_traits_; }
    /// Returns boxes and paddings of all indices, including indices that are not in use.
    Objects objects() const;
    /// Returns the traits of all indices; empty if all objects have the defaults.
    std::span<const Traits> all_traits() const { return with_traits_ ? traits_.span() : std::span<const Traits>(); }
    /// Returns the indices that are free. create() uses the last element first.
    std::span<const std::uint32_t> free() const { return free_; }
    /// Prefetches what other calls read of this object.
    void prefetch(std::uint32_t index) const {
        prefetch_slot(index);
        boxes64_.empty() ? hwy::Prefetch(&boxes32_[index]) : hwy::Prefetch(&boxes64_[index]);
    }
    /// Prefetches what contains() reads. `index` may be out of range.
    void prefetch_slot(std::uint32_t index) const {
        if (index < slots_.size()) hwy::Prefetch(&slots_[index]);
    }

    /// Adds an object at a free index, or at a new index if none is free. Returns its id.
    /// Requires: reserve() has been called for it.
    template <typename Real>
    ObjectId create(const Box<Real>& box, double padding, const Traits& traits);
    /// Requires: the table has precision float32.
    void set_box(std::uint32_t index, const Box3f& box) { boxes32_[index] = box; }
    /// Requires: the table's precision represents `box` exactly.
    void set_box(std::uint32_t index, const Box3d& box);
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

    std::uint32_t new_index();
    template <typename Real>
    static bool equal(const Box<Real>& a, const Box<Real>& b) {
        return std::ranges::equal(a.min, b.min) && std::ranges::equal(a.max, b.max);
    }

    Precision precision_;
    GrowingArray<Box3f> boxes32_;  // used for Precision::float32
    GrowingArray<Box3d> boxes64_;  // used for Precision::float64
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
    if (padded_) paddings_[index] = padding;
    if (with_traits_) traits_[index] = traits;
    return id(index);
}

}  // namespace octopair
