// SIMD steps that kernels of builds share: load boxes, find their cells and leaves. For the instruction set that Highway
// compiles.
//
// Included by kernels after hwy/highway.h, once for each instruction set. Empty for HWY_SCALAR.
#include <hwy/cache_control.h>

#include <algorithm>
#include <array>
#include <cfloat>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "boxes/simd_lanes-inl.hpp"
#include "octree/build/box_locator.hpp"

#if defined(OCTOPAIR_OCTREE_ENCODE_BOX_LANES_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef OCTOPAIR_OCTREE_ENCODE_BOX_LANES_INL_HPP
#undef OCTOPAIR_OCTREE_ENCODE_BOX_LANES_INL_HPP
#else
#define OCTOPAIR_OCTREE_ENCODE_BOX_LANES_INL_HPP
#endif

HWY_BEFORE_NAMESPACE();
namespace octopair {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET != HWY_SCALAR

using Floats = hn::RebindToFloat<Words>;
using FloatLanes = hn::Vec<Floats>;

/// Loads four numbers of each box of a register's lanes. `numbers`: the four numbers of the first box; `stride`: floats from box to box.
HWY_INLINE void load_numbers(const float* numbers, std::size_t stride, Lanes (&registers)[4]) {
    // A float has the same bits as the word that is loaded here.
    const auto* const words = reinterpret_cast<const std::uint32_t*>(numbers);
    load_items(registers, [&](std::size_t i) { return words + i * stride; });
}

/// Constants of BoxLocator in registers.
struct Constants {
    HWY_INLINE explicit Constants(const BoxLocator& locator) : table(locator.table) {
        const Floats d;
        for (unsigned axis = 0; axis < 3; ++axis) {
            origin[axis] = hn::Set(d, locator.map.origin[axis]);
            scale[axis] = hn::Set(d, locator.map.scale[axis]);
            last[axis] = hn::Set(d, locator.map.last[axis]);
        }
    }

    HWY_INLINE Lanes fine_cell(FloatLanes coordinate, unsigned axis) const {
        const Floats d;
        const Words words;
        const auto scaled = hn::Mul(hn::Sub(coordinate, origin[axis]), scale[axis]);
        const auto clamped = hn::Min(hn::Max(scaled, hn::Zero(d)), last[axis]);
        return hn::And(hn::BitCast(words, hn::Add(clamped, hn::Set(d, SpaceMap::whole))),
                       hn::Set(words, SpaceMap::last_fine_cell));
    }

    /// Returns the elements (Directory::Leaf::element()) of the leaves that hold fine cells.
    HWY_INLINE Lanes leaves(const Lanes& x, const Lanes& y, const Lanes& z) const {
        const Lanes cells[3] = {x, y, z};
        auto found = gather(first_position(cells));
        auto deeper = is_deeper(found);
        for (unsigned left = table.shift; HWY_UNLIKELY(!hn::AllFalse(Words(), deeper));) {
            const auto next = next_position(found, left, cells);
            left -= table.levels_below(left);
            found = hn::IfThenElse(deeper, gather(next), found);
            deeper = is_deeper(found);
        }
        return found;
    }

    HWY_INLINE Lanes gather(const Lanes& positions) const {
        const hn::RebindToSigned<Words> indices;
        return hn::GatherIndex(Words(), table.elements, hn::BitCast(indices, positions));
    }
    static HWY_INLINE hn::Mask<Words> is_deeper(const Lanes& element) {
        return hn::Gt(element, hn::Set(Words(), Directory::further - 1));
    }
    /// Returns the positions of the elements that the first table has for fine cells.
    HWY_INLINE Lanes first_position(const Lanes (&cells)[3]) const {
        const Words d;
        const int shift = int(table.shift + SpaceMap::fine_bits);
        const auto row = hn::Add(hn::Mul(hn::ShiftRightSame(cells[2], shift), hn::Set(d, table.sizes[1])),
                                 hn::ShiftRightSame(cells[1], shift));
        return hn::Add(hn::Mul(row, hn::Set(d, table.sizes[0])), hn::ShiftRightSame(cells[0], shift));
    }
    /// Returns the positions of the elements for fine cells in the next tables. `found`: elements that refer to these tables, whose octants
    /// have 2^`left` cells on each axis. The position is 0 if `found` is a leaf.
    HWY_INLINE Lanes next_position(const Lanes& found, unsigned left, const Lanes (&cells)[3]) const {
        const Words d;
        const unsigned levels = table.levels_below(left);
        const auto digits = [&](const Lanes& cell) HWY_ATTR {
            return hn::And(hn::ShiftRightSame(cell, int(left - levels + SpaceMap::fine_bits)),
                           hn::Set(d, (1u << levels) - 1));
        };
        const auto in_table = hn::Or(hn::ShiftLeftSame(digits(cells[2]), int(2 * levels)),
                                     hn::Or(hn::ShiftLeftSame(digits(cells[1]), int(levels)), digits(cells[0])));
        return hn::IfThenElseZero(is_deeper(found), hn::Add(hn::Sub(found, hn::Set(d, Directory::further)), in_table));
    }

    Directory::LeafTable table;
    FloatLanes origin[3], scale[3], last[3];
};

HWY_INLINE Lanes level_of(const Lanes& leaf) { return hn::ShiftRight<Directory::octant_bits>(leaf); }
HWY_INLINE Lanes octant_of(const Lanes& leaf) { return hn::And(leaf, hn::Set(Words(), Directory::max_octants)); }
/// Returns the bits of a fine cell within an octant of a level.
HWY_INLINE Lanes offset_bits(const Lanes& level) { return hn::Shr(hn::Set(Words(), SpaceMap::last_fine_cell), level); }

/// Boxes or entries of a register's lanes: ends by coordinate axis, masks and objects.
struct Loaded {
    FloatLanes low[3], high[3];
    Lanes mask, object;
};

HWY_INLINE Loaded load_lanes(const Box3f* boxes, std::uint32_t object) {
    const Words d;
    const Floats floats;
    Lanes first[4], second[4];
    load_numbers(boxes->min, 6, first);       // min x, y, z, max x
    load_numbers(boxes->min + 2, 6, second);  // min z, max x, y, z
    Loaded loaded;
    for (unsigned axis = 0; axis < 3; ++axis) {
        loaded.low[axis] = hn::BitCast(floats, first[axis]);
        loaded.high[axis] = hn::BitCast(floats, second[axis + 1]);
    }
    loaded.mask = hn::Zero(d);
    loaded.object = hn::Add(lane_numbers(), hn::Set(d, object));
    return loaded;
}

HWY_INLINE Loaded load_lanes(const Entry* entries, std::uint32_t) {
    const Floats floats;
    Lanes first[4], second[4];
    const float* const numbers = entries->min;  // the first of the eight numbers of an entry
    load_numbers(numbers, 8, first);            // min x, y, z, max x
    load_numbers(numbers + 4, 8, second);       // max y, z, object, mask
    Loaded loaded;
    for (unsigned axis = 0; axis < 3; ++axis) loaded.low[axis] = hn::BitCast(floats, first[axis]);
    loaded.high[0] = hn::BitCast(floats, first[3]);
    loaded.high[1] = hn::BitCast(floats, second[0]);
    loaded.high[2] = hn::BitCast(floats, second[1]);
    loaded.object = second[2];
    loaded.mask = second[3];
    return loaded;
}

/// Returns the lanes whose box is valid.
HWY_INLINE hn::Mask<Floats> valid_boxes(const Loaded& box) {
    const auto largest = hn::Set(Floats(), FLT_MAX);
    auto valid = hn::Le(box.low[0], box.high[0]);
    for (unsigned axis = 0; axis < 3; ++axis) {
        const auto finite = hn::And(hn::Le(hn::Abs(box.low[axis]), largest), hn::Le(hn::Abs(box.high[axis]), largest));
        valid = hn::And(valid, hn::And(finite, hn::Le(box.low[axis], box.high[axis])));
    }
    return valid;
}

/// The fine cells of boxes, and the leaves that they begin in.
struct Located {
    HWY_INLINE Located(const Constants& constants, const Loaded& box) {
        for (unsigned axis = 0; axis < 3; ++axis) {
            low[axis] = constants.fine_cell(box.low[axis], axis);
            high[axis] = hn::Max(low[axis], constants.fine_cell(box.high[axis], axis));
        }
        leaf = constants.leaves(low[0], low[1], low[2]);
        level = level_of(leaf);
        offsets = offset_bits(level);
    }
    /// Returns the lanes whose box reaches beyond its leaf.
    HWY_INLINE hn::Mask<Words> crosses() const {
        const auto differing =
            hn::Or(hn::Xor(low[0], high[0]), hn::Or(hn::Xor(low[1], high[1]), hn::Xor(low[2], high[2])));
        return hn::Gt(differing, offsets);
    }
    /// Returns the lanes whose box is too large for its leaf.
    HWY_INLINE hn::Mask<Words> is_large() const {
        constexpr int fine = int(SpaceMap::fine_bits);
        auto extent = hn::Zero(Words());
        for (unsigned axis = 0; axis < 3; ++axis) {
            extent = hn::Or(extent, hn::Sub(hn::ShiftRight<fine>(high[axis]), hn::ShiftRight<fine>(low[axis])));
        }
        return hn::Gt(extent, hn::ShiftRight<fine>(offsets));
    }
    Lanes low[3], high[3], leaf, level, offsets;
};

HWY_INLINE void low_cells(const Constants& constants, const Loaded& box, Lanes (&cells)[3]) {
    for (unsigned axis = 0; axis < 3; ++axis) cells[axis] = constants.fine_cell(box.low[axis], axis);
}

/// Prefetches the table elements that a later look-up of the boxes' leaves reads: first the elements of all boxes in the first table, then
/// the elements in the next tables. So the look-ups of many boxes wait for memory at the same time.
template <typename Item>
HWY_NOINLINE void prefetch_leaves(const Constants& constants, std::span<const Item> items) {
    const Words d;
    const std::size_t lanes = hn::Lanes(d);
    const std::size_t whole = items.size() / lanes * lanes;
    alignas(64) std::array<std::uint32_t, max_encoded> positions;
    const auto prefetch_positions = [&](std::size_t i, const Lanes& at) HWY_ATTR {
        hn::Store(at, d, positions.data() + i);
        for (std::size_t k = i; k < i + lanes; ++k) hwy::Prefetch(constants.table.elements + positions[k]);
    };
    Lanes low[3];
    for (std::size_t i = 0; i < whole; i += lanes) {
        low_cells(constants, load_lanes(items.data() + i, 0), low);
        prefetch_positions(i, constants.first_position(low));
    }
    if (constants.table.shift == constants.table.last_shift) return;
    for (std::size_t i = 0; i < whole; i += lanes) {
        low_cells(constants, load_lanes(items.data() + i, 0), low);
        const auto found = constants.gather(hn::Load(d, positions.data() + i));
        prefetch_positions(i, constants.next_position(found, constants.table.shift, low));
    }
}

/// Loads boxes or entries, a register at a time. Remembers whether all boxes were valid.
template <typename Item>
class LaneReader {
public:
    HWY_INLINE explicit LaneReader(std::span<const Item> items)
        : items_(items), valid_(hn::Eq(hn::Zero(Floats()), hn::Zero(Floats()))) {}

    /// Loads the items from `i` on. Repeats the last item in lanes without an item. `object`: number of the first of all boxes.
    HWY_INLINE Loaded load(std::size_t i, std::uint32_t object) {
        constexpr std::size_t read_ahead = 1536;  // bytes
        const std::size_t lanes = hn::Lanes(Words());
        const Item* from = items_.data() + i;
        const std::size_t left = items_.size() - i;
        if (HWY_UNLIKELY(left < lanes)) {
            for (std::size_t k = 0; k < lanes; ++k) rest_[k] = from[std::min(k, left - 1)];
            from = rest_.data();
        }
        for (std::size_t line = 0; line < lanes * sizeof(Item); line += 64) {
            hwy::Prefetch(reinterpret_cast<const char*>(from) + read_ahead + line);
        }
        const Loaded box = load_lanes(from, object + std::uint32_t(i));
        if constexpr (std::is_same_v<Item, Box3f>) valid_ = hn::And(valid_, valid_boxes(box));
        return box;
    }
    /// Loads numbers[i] and the numbers after it, one for each lane; 0 in lanes without an item. `numbers`: one number for each item.
    HWY_INLINE Lanes numbers(const std::uint32_t* numbers, std::size_t i) const {
        const Words d;
        const std::size_t left = items_.size() - i;
        if (HWY_LIKELY(left >= hn::Lanes(d))) return hn::LoadU(d, numbers + i);
        alignas(64) std::array<std::uint32_t, max_lanes> last = {};
        std::copy_n(numbers + i, left, last.begin());
        return hn::Load(d, last.data());
    }
    /// Returns a bit mask of the lanes that hold an item, from item `i` on.
    HWY_INLINE std::uint32_t live(std::size_t i) const { return first_lanes(items_.size() - i); }
    HWY_INLINE bool all_valid() const { return hn::AllTrue(Floats(), valid_); }

private:
    std::span<const Item> items_;
    hn::Mask<Floats> valid_;
    alignas(64) std::array<Item, max_lanes> rest_;
};

/// Appends the boxes of a register that reach beyond their leaf. `i`: position of the first box in the batch.
HWY_INLINE void append_crossers(const Located& at, std::size_t i, std::uint32_t live, CrosserBatch& batch) {
    const Words d;
    const std::uint32_t crossing = bits_of(d, at.crosses()) & live;
    const LanesToFront to_front(crossing);
    const std::size_t crossers = batch.crossers;
    const auto store = [&](const Lanes& numbers, std::uint32_t* out)
                           HWY_ATTR { hn::StoreU(to_front(numbers), d, out + crossers); };
    store(hn::Add(lane_numbers(), hn::Set(d, std::uint32_t(i))), batch.crosser.data());
    store(at.leaf, batch.leaf.data());
    for (unsigned axis = 0; axis < 3; ++axis) {
        store(at.low[axis], batch.low[axis].data());
        store(at.high[axis], batch.high[axis].data());
    }
    static_assert(CrosserBatch::room >= max_encoded + max_lanes);
    batch.crossers = crossers + hwy::PopCount(crossing);
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace octopair
HWY_AFTER_NAMESPACE();

#endif
