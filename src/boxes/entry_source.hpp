// EntrySource: the boxes of a search, as the octree sees them. Gives their entries, and decides which overlapping entries are pairs.
// Start here to change which boxes count as a pair.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/private_export.hpp"
#include "boxes/entry.hpp"
#include "octopair/objects.hpp"

namespace octopair {

/// True if the pair rule of octopair/objects.hpp holds. `reach`: margin + (padding_a + padding_b).
inline bool within_reach(const Box3d& a, const Box3d& b, double reach) {
    for (int axis = 0; axis < 3; ++axis) {
        if (!(std::max(a.min[axis] - b.max[axis], b.min[axis] - a.max[axis]) <= reach)) return false;
    }
    return true;
}

/// Pairs of overlapping entries. Those in doubt may overlap only because entries are rounded outward, so they need an exact test.
struct DoubtfulPairs {
    std::span<const Pair> pairs;
    std::span<const std::uint32_t> positions;  ///< positions of the pairs in doubt

    const Pair& operator[](std::size_t i) const { return pairs[positions[i]]; }
    std::size_t size() const { return positions.size(); }
};

/// Float32 boxes of some objects: those of the caller, or boxes that were rounded.
struct Float32Boxes {
    std::span<const Box3f> boxes;
    std::uint32_t first_object = 0;          ///< number of the first object; the other numbers follow it
    const std::uint32_t* objects = nullptr;  ///< if not null: the number of each object, in place of `first_object`
    bool valid = true;                       ///< false if a box is rounded from one that is not valid

    std::uint32_t object(std::size_t i) const {
        return objects != nullptr ? objects[i] : first_object + std::uint32_t(i);
    }
};

/// The caller's boxes (box_source.hpp), a part of them, or the entries of a crowded octant (octree/scan).
/// Thread safety: any thread may call it.
class OCTOPAIR_PRIVATE_EXPORT EntrySource {
public:
    virtual ~EntrySource() = default;
    virtual std::size_t size() const = 0;
    /// Writes the entries [begin, begin + out.size()). Returns false if one of the objects is not a valid box.
    virtual bool load(std::size_t begin, std::span<Entry> out) const = 0;
    /// Returns the boxes [begin, begin + room.size()): those of the caller, without a check of their values, or rounded boxes, stored in
    /// `room`. Returns no boxes unless the entries have these bounds, and no bit in their masks.
    virtual Float32Boxes float32_boxes(std::size_t begin, std::span<Box3f> room) const = 0;
    /// Writes the bounds of the entries at `positions`, without a check of their values.
    virtual void pick(std::span<const std::size_t> positions, std::span<Entry> out) const = 0;

    /// True if only pairs between two sets count. The masks of entries separate the sets.
    virtual bool join() const = 0;
    /// Returns the index of the first object of the second set of a join; otherwise 0.
    virtual std::uint32_t second_begin() const = 0;
    /// True if any two overlapping entries are a pair, without a further test.
    virtual bool exact() const = 0;
    /// Returns the slack of entries. Entries that overlap by no more than the slack need the test is_pair().
    virtual RoundingSlack slack() const = 0;
    /// True if the caller's own boxes, before any rounding, are a pair.
    virtual bool is_pair(std::uint32_t a, std::uint32_t b) const = 0;
    /// Returns the bits i of `asked` for which is_pair(objects[i], other). A class that overrides is_pair() need not override this function.
    virtual std::uint32_t pairs_with(const std::uint32_t* objects, std::uint32_t other, std::uint32_t asked) const {
        return kept_bits(asked, [&](unsigned i) { return is_pair(objects[i], other); });
    }
    /// Writes the positions of the doubtful pairs that fail the test is_pair() to `out`, in the same order, and returns their number.
    /// Requires: `out` has room for all positions.
    virtual std::size_t refused(const DoubtfulPairs& doubtful, std::uint32_t* out) const = 0;
    /// Sets the bounds of entries whose object is set.
    virtual void load_bounds(std::span<Entry> entries) const = 0;
    /// True if load_bounds() works for all entries. On a rank that received entries, the boxes of most objects are on other ranks.
    virtual bool has_all_bounds() const { return true; }

protected:
    /// Returns the bits i of `asked` for which keep(i) is true.
    template <typename Keep>
    static std::uint32_t kept_bits(std::uint32_t asked, Keep&& keep) {
        std::uint32_t kept = 0;
        for (std::uint32_t rest = asked; rest != 0; rest &= rest - 1) {
            const auto bit = unsigned(std::countr_zero(rest));
            kept |= std::uint32_t(keep(bit)) << bit;
        }
        return kept;
    }
    /// Does what refused() does, with a call of is_pair() for each pair in doubt.
    std::size_t refused_one_by_one(const DoubtfulPairs& doubtful, std::uint32_t* out) const {
        std::size_t count = 0;
        for (std::size_t i = 0; i < doubtful.size(); ++i) {
            out[count] = doubtful.positions[i];
            count += is_pair(doubtful[i].a, doubtful[i].b) ? 0 : 1;
        }
        return count;
    }
};

/// Passes every call on to another source. Derived classes change some of them. Borrows the source.
class ForwardingSource : public EntrySource {
public:
    explicit ForwardingSource(const EntrySource& source) : source_(source) {}
    std::size_t size() const override { return source_.size(); }
    bool load(std::size_t begin, std::span<Entry> out) const override { return source_.load(begin, out); }
    Float32Boxes float32_boxes(std::size_t begin, std::span<Box3f> room) const override {
        return source_.float32_boxes(begin, room);
    }
    void pick(std::span<const std::size_t> positions, std::span<Entry> out) const override {
        source_.pick(positions, out);
    }
    bool join() const override { return source_.join(); }
    std::uint32_t second_begin() const override { return source_.second_begin(); }
    bool exact() const override { return source_.exact(); }
    RoundingSlack slack() const override { return source_.slack(); }
    bool is_pair(std::uint32_t a, std::uint32_t b) const override { return source_.is_pair(a, b); }
    std::size_t refused(const DoubtfulPairs& doubtful, std::uint32_t* out) const override {
        return source_.refused(doubtful, out);
    }
    void load_bounds(std::span<Entry> entries) const override { source_.load_bounds(entries); }

protected:
    const EntrySource& source() const { return source_; }

private:
    const EntrySource& source_;
};

}  // namespace octopair
