// SIMD version of encode: loads a register of boxes, finds their cells and leaves, and makes their entries. Highway compiles it for
// each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "octree/build/encoder_kernel.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cfloat>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

#include "base/tuning.hpp"
#include "boxes/simd_lanes-inl.hpp"
#include "octree/build/encoder.hpp"

HWY_BEFORE_NAMESPACE();
namespace octopair {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

bool locate_boxes_simd(const BoxLocator& locator, std::span<const Box3f> boxes, LocatedBatch& batch) {
    return locator.locate_scalar(boxes, batch);
}
void locate_entries_simd(const BoxLocator& locator, std::span<const Entry> entries, LocatedBatch& batch) {
    locator.locate_scalar(entries, batch);
}
bool encode_boxes_simd(const BatchEncoder& encoder, const Float32Boxes& boxes, EncodedBatch& batch) {
    return encoder.encode_scalar(boxes, batch);
}
void encode_entries_simd(const BatchEncoder& encoder, std::span<const Entry> entries, EncodedBatch& batch) {
    encoder.encode_scalar(entries, batch);
}
void ghosts_simd(const BatchEncoder&, const EncodedBatch&, CrosserRange crossers, GhostGroup& group) {
    BatchEncoder::ghosts_scalar(crossers, group);
}

#else

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

template <typename Item>
bool locate_lanes(const BoxLocator& locator, std::span<const Item> items, LocatedBatch& batch) {
    const Words d;
    const Constants constants(locator);
    if (locator.large_table) prefetch_leaves(constants, items);
    batch.crossers = 0;
    LaneReader<Item> reader(items);
    for (std::size_t i = 0; i < items.size(); i += hn::Lanes(d)) {
        const Located at(constants, reader.load(i, 0));
        hn::StoreU(at.leaf, d, batch.leaves.data() + i);
        append_crossers(at, i, reader.live(i), batch);
    }
    for (std::size_t i = 0; i < batch.crossers; i += hn::Lanes(d)) {
        const auto end = [&](unsigned axis) HWY_ATTR { return hn::LoadU(d, batch.high[axis].data() + i); };
        hn::StoreU(constants.leaves(end(0), end(1), end(2)), d, batch.end_leaf.data() + i);
    }
    return reader.all_valid();
}

bool locate_boxes_simd(const BoxLocator& locator, std::span<const Box3f> boxes, LocatedBatch& batch) {
    return locate_lanes(locator, boxes, batch);
}
void locate_entries_simd(const BoxLocator& locator, std::span<const Entry> entries, LocatedBatch& batch) {
    (void)locate_lanes(locator, entries, batch);
}

/// Stores the entries of a register's lanes, given as registers of one number each. at(i): place of entry i.
template <typename At>
HWY_INLINE void store_entries(Lanes (&numbers)[4], const At& at) {
    transpose(numbers);
    for (std::size_t i = 0; i < 4; ++i) {
        store_blocks(Words(), numbers[i], i, [&](std::size_t k) { return at(k).ends.data(); });
    }
}

/// Converts fine cells within an octant of `level` to the octant's own cells.
HWY_INLINE Lanes octant_cells(const Lanes& fine_cell, const Lanes& level) {
    const Words d;
    const auto aligned = hn::And(hn::Shl(fine_cell, level), hn::Set(d, SpaceMap::last_fine_cell));
    return hn::ShiftRight<int(OctantCells::max_fine_level)>(aligned);
}

/// Replaces the ends of boxes in deep leaves by cells that are counted from the origin of the leaf.
HWY_INLINE void replace_deep(const BatchEncoder& encoder, const Lanes& leaf, const Loaded& box, Lanes (&words)[4]) {
    const Words d;
    const Floats floats;
    const hn::RebindToSigned<Words> indices;
    const auto is_deep = hn::Gt(level_of(leaf), hn::Set(d, OctantCells::max_fine_level));
    if (HWY_LIKELY(hn::AllFalse(d, is_deep))) return;
    const auto octant = hn::IfThenElseZero(is_deep, octant_of(leaf));
    const auto exponent = hn::Add(level_of(leaf), hn::Set(d, 127 - OctantCells::max_fine_level));
    const auto factor = hn::BitCast(floats, hn::ShiftLeft<23>(exponent));
    for (unsigned k = 0; k < 3; ++k) {
        const unsigned axis = encoder.axes[k];
        const auto at = hn::BitCast(indices, hn::Add(hn::ShiftLeft<2>(octant), hn::Set(d, axis)));
        const auto origin = hn::GatherIndex(floats, encoder.deep_origins[0].data(), at);
        const auto scale = hn::Mul(hn::Set(floats, encoder.locator.map.scale[axis]), factor);
        const auto cell = [&](FloatLanes coordinate) HWY_ATTR {
            const auto in_octant = hn::Mul(hn::Sub(coordinate, origin), scale);
            const auto clamped =
                hn::Min(hn::Max(in_octant, hn::Zero(floats)), hn::Set(floats, float(last_octant_cell)));
            return hn::And(hn::BitCast(d, hn::Add(clamped, hn::Set(floats, SpaceMap::whole))),
                           hn::Set(d, last_octant_cell));
        };
        const auto ends = hn::Or(cell(box.low[axis]), hn::ShiftLeft<16>(cell(box.high[axis])));
        words[k] = hn::IfThenElse(is_deep, ends, words[k]);
    }
}

/// Makes home entries. `masked`: the boxes have masks.
template <bool masked>
HWY_INLINE void home_entries(const BatchEncoder& encoder, const Loaded& box, const Located& at, Lanes (&words)[4]) {
    const Words d;
    for (unsigned k = 0; k < 3; ++k) {
        const unsigned axis = encoder.axes[k];
        const auto end = hn::Min(at.high[axis], hn::Or(at.low[axis], at.offsets));
        words[k] = hn::Or(octant_cells(at.low[axis], at.level), hn::ShiftLeft<16>(octant_cells(end, at.level)));
    }
    replace_deep(encoder, at.leaf, box, words);
    for (unsigned k = 0; masked && k < 3; ++k) {
        const auto one = hn::Set(d, 1u);
        const auto class_bit = hn::And(hn::ShiftRightSame(box.mask, int(encoder.axes[k])), one);
        const auto set_bit = hn::And(hn::ShiftRightSame(box.mask, int(3 + k)), one);
        words[k] = hn::Or(words[k], hn::Or(hn::ShiftLeft<int(CellEntry::class_shift)>(class_bit),
                                           hn::ShiftLeft<int(CellEntry::set_shift)>(set_bit)));
    }
    words[3] = box.object;
}

/// Encodes boxes or entries. `boxes`: the numbers of the objects, if the items are boxes.
template <typename Item>
bool encode_lanes(const BatchEncoder& encoder, std::span<const Item> items, const Float32Boxes& boxes,
                  EncodedBatch& batch) {
    const Words d;
    const Constants constants(encoder.locator);
    if (encoder.locator.large_table) prefetch_leaves(constants, items);
    batch.crossers = 0;
    LaneReader<Item> reader(items);
    for (std::size_t i = 0; i < items.size(); i += hn::Lanes(d)) {
        Loaded box = reader.load(i, boxes.first_object);
        if (boxes.objects != nullptr) box.object = reader.numbers(boxes.objects, i);
        const Located at(constants, box);
        const auto list = hn::IfThenElse(at.is_large(), hn::Set(d, encoder.no_list), octant_of(at.leaf));
        hn::StoreU(list, d, batch.lists.data() + i);
        Lanes words[4];
        home_entries<std::is_same_v<Item, Entry>>(encoder, box, at, words);
        store_entries(words, [&](std::size_t k) -> CellEntry& { return batch.homes[i + k]; });
        append_crossers(at, i, reader.live(i), batch);
    }
    return reader.all_valid();
}

bool encode_boxes_simd(const BatchEncoder& encoder, const Float32Boxes& boxes, EncodedBatch& batch) {
    return encode_lanes(encoder, boxes.boxes, boxes, batch);
}
void encode_entries_simd(const BatchEncoder& encoder, std::span<const Entry> entries, EncodedBatch& batch) {
    (void)encode_lanes(encoder, entries, {}, batch);
}

struct GhostSource {
    const BatchEncoder& encoder;
    const EncodedBatch& batch;
};

/// Makes the ghosts of at most as many crossers as a register has lanes. `lane`: number of the first one in the group.
HWY_INLINE void ghosts_of_lanes(const GhostSource& source, CrosserRange crossers, std::size_t lane, GhostGroup& group) {
    const auto& [encoder, batch] = source;
    const std::size_t begin = crossers.begin;
    const std::uint32_t live = (1u << crossers.count) - 1;
    const Words d;
    const Constants constants(encoder.locator);
    Lanes low[3], high[3];
    for (unsigned axis = 0; axis < 3; ++axis) {
        low[axis] = hn::LoadU(d, batch.low[axis].data() + begin);
        high[axis] = hn::LoadU(d, batch.high[axis].data() + begin);
    }
    const auto leaf = hn::LoadU(d, batch.leaf.data() + begin);
    const auto level = level_of(leaf), offsets = offset_bits(level);
    std::uint32_t crossed[3];
    auto extent = hn::Zero(d);
    for (unsigned axis = 0; axis < 3; ++axis) {
        crossed[axis] = bits_of(d, hn::Gt(hn::Xor(low[axis], high[axis]), offsets));
        extent = hn::Or(extent, hn::Sub(hn::ShiftRight<SpaceMap::fine_bits>(high[axis]),
                                        hn::ShiftRight<SpaceMap::fine_bits>(low[axis])));
    }
    std::uint32_t left_out = bits_of(d, hn::Gt(extent, hn::ShiftRight<SpaceMap::fine_bits>(offsets))) & live;
    Lanes homes[4];
    load_items(homes, [&](std::size_t i) { return batch.homes[batch.crosser[begin + i]].ends.data(); });
    const auto flags = hn::Set(d, CellEntry::flag_bits),
               finest = hn::Min(level, hn::Set(d, OctantCells::max_fine_level));
    alignas(64) std::uint32_t slots[max_lanes], octants[max_lanes];
    const auto first_slot = hn::ShiftLeft<3>(hn::Add(lane_numbers(), hn::Set(d, std::uint32_t(lane))));
    static_assert(GhostGroup::slots == 1 << 3 && GhostGroup::most % max_lanes == 0);
    hn::Store(first_slot, d, slots);
    for (unsigned corner = 1; corner < GhostGroup::slots; ++corner) {
        std::uint32_t has = live & ~left_out;
        for (unsigned axis = 0; axis < 3; ++axis) has &= corner >> axis & 1u ? crossed[axis] : ~0u;
        if (has == 0) continue;
        const auto end = [&](unsigned axis) HWY_ATTR { return corner >> axis & 1u ? high[axis] : low[axis]; };
        const auto corner_leaf = constants.leaves(end(0), end(1), end(2));
        const auto corner_level = level_of(corner_leaf), in_corner = offset_bits(corner_level);
        left_out |= bits_of(d, hn::Gt(corner_level, finest)) & has;
        has &= ~left_out;
        Lanes words[4];
        for (unsigned k = 0; k < 3; ++k) {
            const unsigned axis = encoder.axes[k];
            if (corner >> axis & 1u) {  // the octant holds the high end, so the box begins before the octant
                has &= bits_of(d, hn::Lt(low[axis], hn::AndNot(in_corner, high[axis])));
                words[k] =
                    hn::Or(hn::Set(d, CellEntry::class_bit), hn::ShiftLeft<16>(octant_cells(high[axis], corner_level)));
            } else {
                const auto last = hn::Min(high[axis], hn::Or(low[axis], in_corner));
                words[k] =
                    hn::Or(octant_cells(low[axis], corner_level), hn::ShiftLeft<16>(octant_cells(last, corner_level)));
            }
            words[k] = hn::Or(words[k], hn::And(homes[k], flags));
        }
        words[3] = homes[3];
        // Every crosser's slot is written. It is kept if the crosser has the ghost, and overwritten otherwise.
        store_entries(words, [&](std::size_t i) -> CellEntry& { return group.entries[slots[i]]; });
        hn::Store(octant_of(corner_leaf), d, octants);
        for (std::size_t i = 0; i < hn::Lanes(d); ++i) {
            group.octants[slots[i]] = octants[i];
            slots[i] += has >> i & 1u;
        }
    }
    hn::Store(hn::Sub(hn::Load(d, slots), first_slot), d, group.counts.data() + lane);
    group.left_out |= left_out << lane;
}

void ghosts_simd(const BatchEncoder& encoder, const EncodedBatch& batch, CrosserRange crossers, GhostGroup& group) {
    const std::size_t lanes = hn::Lanes(Words());
    group.left_out = 0;
    for (std::size_t lane = 0; lane < crossers.count; lane += lanes) {
        const CrosserRange some{crossers.begin + lane, std::min(crossers.count - lane, lanes)};
        ghosts_of_lanes({encoder, batch}, some, lane, group);
    }
}

#endif

}  // namespace HWY_NAMESPACE
}  // namespace octopair
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace octopair {

BoxLocator::BoxLocator(const Space& space, const Directory& directory)
    : map(space.map()),
      table(directory.leaf_table()),
      large_table(table.size > tuning().large.max_near_table),
      space_(space),
      directory_(directory) {}

BatchEncoder::BatchEncoder(const Space& space, const Directory& directory, std::uint32_t no_list_number)
    : locator(space, directory), no_list(no_list_number), space_(space), directory_(directory) {
    for (unsigned k = 0; k < 3; ++k) axes[k] = (space.long_axis() + k) % 3;
    const std::span<const Octant> octants = directory.octants();
    const auto is_deep = [](const Octant& octant) { return octant.level > OctantCells::max_fine_level; };
    if (std::ranges::none_of(octants, is_deep)) return;
    deep_origins.reserve(octants.size());
    for (const Octant& octant : octants) deep_origins.push_back(OctantCells::deep_origin(locator.map, octant));
}

HWY_EXPORT(locate_boxes_simd);
HWY_EXPORT(locate_entries_simd);

bool BoxLocator::locate(std::span<const Box3f> boxes, LocatedBatch& batch) const {
    return HWY_DYNAMIC_DISPATCH(locate_boxes_simd)(*this, boxes, batch);
}

void BoxLocator::locate(std::span<const Entry> entries, LocatedBatch& batch) const {
    HWY_DYNAMIC_DISPATCH(locate_entries_simd)(*this, entries, batch);
}

HWY_EXPORT(encode_boxes_simd);
HWY_EXPORT(encode_entries_simd);
HWY_EXPORT(ghosts_simd);

bool BatchEncoder::encode(const Float32Boxes& boxes, EncodedBatch& batch) const {
    return HWY_DYNAMIC_DISPATCH(encode_boxes_simd)(*this, boxes, batch);
}

void BatchEncoder::encode(std::span<const Entry> entries, EncodedBatch& batch) const {
    HWY_DYNAMIC_DISPATCH(encode_entries_simd)(*this, entries, batch);
}

void BatchEncoder::ghosts(const EncodedBatch& batch, CrosserRange crossers, GhostGroup& group) const {
    HWY_DYNAMIC_DISPATCH(ghosts_simd)(*this, batch, crossers, group);
}

}  // namespace octopair

#endif  // HWY_ONCE
