// SIMD version of BatchEncoder. Highway compiles it for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "octree/build/batch_encoder_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "octree/build/batch_encoder.hpp"
#include "octree/build/box_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace octopair {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

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
