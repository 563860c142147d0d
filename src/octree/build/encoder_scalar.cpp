// Specification of the SIMD versions of encoder_kernel.cpp. Searches run it only on processors without SIMD.
#include <algorithm>
#include <cstring>

#include "boxes/box_check.hpp"
#include "octree/build/encoder.hpp"

namespace octopair {

bool make_entries(const Float32Boxes& boxes, BatchEntries& entries) {
    bool good = true;
    for (std::size_t i = 0; i < boxes.boxes.size(); ++i) {
        good &= is_box(boxes.boxes[i]);
        std::memcpy(&entries[i], &boxes.boxes[i], sizeof(Box3f));
        entries[i].object = boxes.object(i);
        entries[i].mask = 0;
    }
    return good;
}

Directory::Leaf BoxLocator::locate(const Entry& entry, std::uint32_t position, CrosserBatch& crossers) const {
    const CellBox cells = space_.cells(entry);
    const Directory::Leaf leaf = directory_.leaf(cells.lo);
    if (within(cells, leaf.level())) return leaf;
    const std::size_t crosser = crossers.crossers++;
    crossers.crosser[crosser] = position;
    crossers.leaf[crosser] = leaf.element();
    for (unsigned axis = 0; axis < 3; ++axis) {
        crossers.low[axis][crosser] = map.fine_cell(entry.min[axis], axis);
        crossers.high[axis][crosser] = std::max(crossers.low[axis][crosser], map.fine_cell(entry.max[axis], axis));
    }
    return leaf;
}

bool BoxLocator::locate_scalar(std::span<const Box3f> boxes, LocatedBatch& batch) const {
    BatchEntries entries;
    const bool good = make_entries({boxes}, entries);
    locate_scalar(std::span<const Entry>(entries).first(boxes.size()), batch);
    return good;
}

void BoxLocator::locate_scalar(std::span<const Entry> entries, LocatedBatch& batch) const {
    batch.crossers = 0;
    for (std::uint32_t i = 0; i < entries.size(); ++i) batch.leaves[i] = locate(entries[i], i, batch).element();
    for (std::size_t i = 0; i < batch.crossers; ++i) batch.end_leaf[i] = directory_.leaf(batch.cells(i).hi).element();
}

bool BatchEncoder::encode_scalar(const Float32Boxes& boxes, EncodedBatch& batch) const {
    BatchEntries entries;
    const bool good = make_entries(boxes, entries);
    encode_scalar(std::span<const Entry>(entries).first(boxes.boxes.size()), batch);
    return good;
}

void BatchEncoder::encode_scalar(std::span<const Entry> entries, EncodedBatch& batch) const {
    batch.crossers = 0;
    for (std::uint32_t i = 0; i < entries.size(); ++i) {
        const Directory::Leaf leaf = locator.locate(entries[i], i, batch);
        batch.homes[i] = OctantCells(space_, directory_.octants()[leaf.octant()]).entry(entries[i]);
        batch.lists[i] = natural_level(space_.cells(entries[i])) < leaf.level() ? no_list : leaf.octant();
    }
}

void BatchEncoder::ghosts_scalar(CrosserRange crossers, GhostGroup& group) {
    group.counts = {};
    group.left_out = (1u << crossers.count) - 1;
}

}  // namespace octopair
