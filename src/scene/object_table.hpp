// ObjectTable: the objects of a scene by index: their boxes, paddings and traits, and which ids are alive.
//
// The arrays that few scenes need (paddings, traits) are there from the first object on that has other than the default.
// What an index held that is not in use is a valid box that means nothing.
#pragma once

#include <hwy/cache_control.h>

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

/// An object at one time.
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
    double padding(std::uint32_t index) const { return padded_ ? paddings_[index] : 0; }
    Traits traits(std::uint32_t index) const { return with_traits_ ? traits_[index] : Traits{}; }
    ObjectState state(std::uint32_t index) const { return {alive(index), box(index), padding(index), traits(index)}; }
    bool any_padding() const { return padded_; }
    bool any_traits() const { return with_traits_; }
    /// All indices, those not in use too.
    Objects objects() const;
    /// The same; empty if all have the defaults.
    std::span<const Traits> all_traits() const { return with_traits_ ? traits_.span() : std::span<const Traits>(); }
    /// Indices not in use; the last is the next to be.
    std::span<const std::uint32_t> free() const { return free_; }
    /// For what is called here of that object soon.
    void prefetch(std::uint32_t index) const {
        prefetch_slot(index);
        boxes64_.empty() ? hwy::Prefetch(&boxes32_[index]) : hwy::Prefetch(&boxes64_[index]);
    }
    /// The same for contains(); any index.
    void prefetch_slot(std::uint32_t index) const {
        if (index < slots_.size()) hwy::Prefetch(&slots_[index]);
    }

    /// A new object at a free or a further index. To be reserved for.
    template <typename Real>
    ObjectId create(const Box<Real>& box, double padding, const Traits& traits);
    /// Of the table's precision, or one that it holds exactly.
    void set_box(std::uint32_t index, const Box3f& box) { boxes32_[index] = box; }
    void set_box(std::uint32_t index, const Box3d& box);
    /// To be reserved for.
    void set_traits(std::uint32_t index, const Traits& traits) {
        if (with_traits_) traits_[index] = traits;
    }
    /// It is alive no longer; its index is not free before release().
    void kill(std::uint32_t index) {
        ++slots_[index].generation;
        --size_;
    }
    void release(std::uint32_t index) { free_.push_back(index); }
    /// Memory for so many calls of release().
    void reserve_release(std::size_t more) { reserve_more(free_, more); }
    /// Memory for so many more, and for what not all objects have where one of them is going to.
    void reserve(std::uint64_t more, bool with_padding, bool with_traits);

    /// A mark that the change log keeps for each object (change_log.hpp); none at first.
    std::uint32_t mark(std::uint32_t index) const { return slots_[index].mark; }
    void set_mark(std::uint32_t index, std::uint32_t mark) { slots_[index].mark = mark; }

private:
    struct Slot {
        std::uint32_t generation;  ///< odd: alive
        std::uint32_t mark;
    };

    std::uint32_t new_index();

    Precision precision_;
    GrowingArray<Box3f> boxes32_;  // empty if the precision is the other one
    GrowingArray<Box3d> boxes64_;
    GrowingArray<Slot> slots_;
    bool padded_ = false, with_traits_ = false;
    GrowingArray<double> paddings_;  // if padded_
    GrowingArray<Traits> traits_;    // if with_traits_
    std::vector<std::uint32_t> free_;
    std::uint64_t size_ = 0;  // alive
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
