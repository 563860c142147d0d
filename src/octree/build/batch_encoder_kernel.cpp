// SIMD version of BatchEncoder. Highway compiles it for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "octree/build/batch_encoder_kernel.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cfloat>
#include <cstring>

#include "boxes/box_kernel.hpp"
#include "octree/build/batch_encoder.hpp"
#include "octree/simd_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace octopair {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

bool encode_boxes_simd(const BatchEncoder& encoder, std::span<const Box3f> boxes, std::uint32_t object,
                       EncodedBatch& batch) {
    return encoder.encode_scalar(boxes, object, batch);
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

/// Loads four numbers of each box of a register's lanes. `numbers`: those of the first box; `stride`: from box to box.
HWY_INLINE void load_numbers(const float* numbers, std::size_t stride, Lanes (&registers)[4]) {
    // A float has the same bits as the word that is loaded here.
    const auto* const words = reinterpret_cast<const std::uint32_t*>(numbers);
    load_items(registers, [&](std::size_t i) { return words + i * stride; });
}

/// Stores the entries of a register's lanes, given as registers of one number each.
template <typename D>
HWY_INLINE void store_entries(D d, Lanes (&numbers)[4], CellEntry* out) {
    transpose(numbers);
    for (std::size_t i = 0; i < 4; ++i) {
        const hn::Vec<D> blocks = numbers[i];
        if constexpr (hn::MaxLanes(D()) == 8) {
            const hn::Half<D> block;
            hn::Store(hn::LowerHalf(block, blocks), block, out[i].ends.data());
            hn::Store(hn::UpperHalf(block, blocks), block, out[i + 4].ends.data());
        } else {
            hn::Store(blocks, d, out[i].ends.data());
        }
    }
}

/// Constants of BatchEncoder in registers.
struct Constants {
    HWY_INLINE explicit Constants(const BatchEncoder& encoder) : table(encoder.table) {
        const Floats d;
        for (unsigned axis = 0; axis < 3; ++axis) {
            origin[axis] = hn::Set(d, encoder.map.origin[axis]);
            scale[axis] = hn::Set(d, encoder.map.scale[axis]);
            last[axis] = hn::Set(d, encoder.map.last[axis]);
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
    /// Returns the positions of fine cells in the first table.
    HWY_INLINE Lanes first_position(const Lanes (&cells)[3]) const {
        const Words d;
        const int shift = int(table.shift + SpaceMap::fine_bits);
        const auto row = hn::Add(hn::Mul(hn::ShiftRightSame(cells[2], shift), hn::Set(d, table.sizes[1])),
                                 hn::ShiftRightSame(cells[1], shift));
        return hn::Add(hn::Mul(row, hn::Set(d, table.sizes[0])), hn::ShiftRightSame(cells[0], shift));
    }
    /// Returns the positions of fine cells in the tables that `found` refers to, below octants of 2^`left` cells on each axis;
    /// 0 for a leaf.
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
/// Returns the octant's cells of fine cells that lie in the octant.
HWY_INLINE Lanes octant_cells(const Lanes& fine_cell, const Lanes& level) {
    const Words d;
    const auto aligned = hn::And(hn::Shl(fine_cell, level), hn::Set(d, SpaceMap::last_fine_cell));
    return hn::ShiftRight<int(OctantCells::max_fine_level)>(aligned);
}

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
    loaded.object = hn::Iota(d, object);
    return loaded;
}

HWY_INLINE Loaded load_lanes(const Entry* entries, std::uint32_t) {
    const Floats floats;
    Lanes first[4], second[4];
    const float* const numbers = entries->min;  // of all eight numbers of an entry
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

/// Replaces the ends of boxes whose leaves are deep: their cells are counted from the leaves' own origins.
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
        const auto scale = hn::Mul(hn::Set(floats, encoder.map.scale[axis]), factor);
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
        words[k] = hn::Or(words[k], hn::Or(hn::ShiftLeft<15>(class_bit), hn::ShiftLeft<31>(set_bit)));
    }
    words[3] = box.object;
}

HWY_INLINE void low_cells(const Constants& constants, const Loaded& box, Lanes (&cells)[3]) {
    for (unsigned axis = 0; axis < 3; ++axis) cells[axis] = constants.fine_cell(box.low[axis], axis);
}

/// Prefetches the elements that the leaves of boxes are looked up in: those of all boxes in the first table, then those in the
/// tables below. So the look-ups of many boxes wait for memory at the same time.
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

constexpr std::size_t read_ahead = 1536;  // bytes: distance at which boxes are prefetched

template <typename Item>
bool encode_lanes(const BatchEncoder& encoder, std::span<const Item> items, std::uint32_t object, EncodedBatch& batch) {
    constexpr bool masked = std::is_same_v<Item, Entry>;
    const Words d;
    const std::size_t lanes = hn::Lanes(d);
    const Constants constants(encoder);
    if (encoder.large_table) prefetch_leaves(constants, items);
    auto good = hn::Eq(hn::Zero(Floats()), hn::Zero(Floats()));
    std::size_t crossers = 0;
    alignas(64) std::array<Item, LaneTable::lanes> rest;
    for (std::size_t i = 0; i < items.size(); i += lanes) {
        const Item* from = items.data() + i;
        const std::size_t left = items.size() - i;
        if (HWY_UNLIKELY(left < lanes)) {
            for (std::size_t k = 0; k < lanes; ++k) rest[k] = from[std::min(k, left - 1)];
            from = rest.data();
        }
        for (std::size_t line = 0; line < lanes * sizeof(Item); line += 64) {
            hwy::Prefetch(reinterpret_cast<const char*>(from) + read_ahead + line);
        }
        const Loaded box = load_lanes(from, object + std::uint32_t(i));
        if constexpr (!masked) good = hn::And(good, valid_boxes(box));
        const Located at(constants, box);
        const auto list = hn::IfThenElse(at.is_large(), hn::Set(d, encoder.no_list), octant_of(at.leaf));
        hn::StoreU(list, d, batch.lists.data() + i);
        Lanes words[4];
        home_entries<masked>(encoder, box, at, words);
        store_entries(d, words, batch.homes.data() + i);
        const std::uint32_t live = left >= lanes ? 0xFFu : (1u << left) - 1;
        const std::uint32_t crossing = bits_of(d, at.crosses()) & live;
        const auto order = to_front(crossing);
        const auto store = [&](const Lanes& numbers, std::uint32_t* out)
                               HWY_ATTR { hn::StoreU(hn::TableLookupLanes(numbers, order), d, out + crossers); };
        store(hn::Iota(d, std::uint32_t(i)), batch.crosser.data());
        store(at.leaf, batch.leaf.data());
        for (unsigned axis = 0; axis < 3; ++axis) {
            store(at.low[axis], batch.low[axis].data());
            store(at.high[axis], batch.high[axis].data());
        }
        crossers += lanes_in.count[crossing];
    }
    batch.crossers = crossers;
    return masked || hn::AllTrue(Floats(), good);
}

bool encode_boxes_simd(const BatchEncoder& encoder, std::span<const Box3f> boxes, std::uint32_t object,
                       EncodedBatch& batch) {
    return encode_lanes(encoder, boxes, object, batch);
}
void encode_entries_simd(const BatchEncoder& encoder, std::span<const Entry> entries, EncodedBatch& batch) {
    (void)encode_lanes(encoder, entries, 0, batch);
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
    const hn::RebindToSigned<Words> indices;
    const Constants constants(encoder);
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
    Lanes leaf_at[GhostGroup::corners];
    std::uint32_t present[GhostGroup::corners];
    for (unsigned corner = 1; corner <= GhostGroup::corners; ++corner) {
        std::uint32_t& has = present[corner - 1];
        has = live & ~left_out;
        for (unsigned axis = 0; axis < 3; ++axis) has &= corner >> axis & 1u ? crossed[axis] : ~0u;
        if (has == 0) continue;
        const auto end = [&](unsigned axis) HWY_ATTR { return corner >> axis & 1u ? high[axis] : low[axis]; };
        leaf_at[corner - 1] = constants.leaves(end(0), end(1), end(2));
        const auto finest = hn::Min(level, hn::Set(d, OctantCells::max_fine_level));
        left_out |= bits_of(d, hn::Gt(level_of(leaf_at[corner - 1]), finest)) & has;
    }
    const auto home = hn::ShiftLeft<2>(hn::LoadU(d, batch.crosser.data() + begin));
    const std::uint32_t* const homes = batch.homes[0].ends.data();
    const auto of_home = [&](std::uint32_t word) HWY_ATTR {
        return hn::GatherIndex(d, homes, hn::BitCast(indices, hn::Add(home, hn::Set(d, word))));
    };
    const auto flags = hn::Set(d, CellEntry::flag_bits);
    const Lanes brought[3] = {hn::And(of_home(0), flags), hn::And(of_home(1), flags), hn::And(of_home(2), flags)};
    const auto object = of_home(3);
    for (unsigned corner = 1; corner <= GhostGroup::corners; ++corner) {
        std::uint32_t has = present[corner - 1] & ~left_out;
        if (has != 0) {
            const auto corner_leaf = leaf_at[corner - 1];
            const auto corner_level = level_of(corner_leaf), in_corner = offset_bits(corner_level);
            Lanes words[4];
            for (unsigned k = 0; k < 3; ++k) {
                const unsigned axis = encoder.axes[k];
                if (corner >> axis & 1u) {  // the octant holds the high end
                    const auto first = hn::AndNot(in_corner, high[axis]);
                    has &= bits_of(d, hn::Lt(low[axis], first));
                    words[k] = hn::Or(hn::Set(d, 1u << 15), hn::ShiftLeft<16>(octant_cells(high[axis], corner_level)));
                } else {
                    const auto end = hn::Min(high[axis], hn::Or(low[axis], in_corner));
                    words[k] = hn::Or(octant_cells(low[axis], corner_level),
                                      hn::ShiftLeft<16>(octant_cells(end, corner_level)));
                }
                words[k] = hn::Or(words[k], brought[k]);
            }
            words[3] = object;
            store_entries(d, words, group.entries[corner - 1].data() + lane);
            hn::StoreU(octant_of(corner_leaf), d, group.octants[corner - 1].data() + lane);
        }
        group.present[corner - 1] = std::uint8_t(group.present[corner - 1] | has << lane);
    }
    group.left_out |= left_out << lane;
}

void ghosts_simd(const BatchEncoder& encoder, const EncodedBatch& batch, CrosserRange crossers, GhostGroup& group) {
    const std::size_t lanes = hn::Lanes(Words());
    group.present = {};
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

HWY_EXPORT(encode_boxes_simd);
HWY_EXPORT(encode_entries_simd);
HWY_EXPORT(ghosts_simd);

bool BatchEncoder::encode(std::span<const Box3f> boxes, std::uint32_t object, EncodedBatch& batch) const {
    return HWY_DYNAMIC_DISPATCH(encode_boxes_simd)(*this, boxes, object, batch);
}

void BatchEncoder::encode(std::span<const Entry> entries, EncodedBatch& batch) const {
    HWY_DYNAMIC_DISPATCH(encode_entries_simd)(*this, entries, batch);
}

void BatchEncoder::ghosts(const EncodedBatch& batch, CrosserRange crossers, GhostGroup& group) const {
    HWY_DYNAMIC_DISPATCH(ghosts_simd)(*this, batch, crossers, group);
}

}  // namespace octopair

#endif  // HWY_ONCE
