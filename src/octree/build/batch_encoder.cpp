#include <algorithm>
#include <cstring>

#include "base/tuning.hpp"
#include "boxes/box_kernel.hpp"
#include "octree/build/batch_encoder.hpp"
#include "octree/build/octants_of.hpp"

namespace octopair {

BatchEncoder::BatchEncoder(const Space& space, const Directory& directory, std::uint32_t no_list_number)
    : map(space.map()),
      table(directory.leaf_table()),
      large_table(table.size > tuning().large.max_near_table),
      no_list(no_list_number),
      space_(space),
      directory_(directory) {
    for (unsigned k = 0; k < 3; ++k) axes[k] = (space.long_axis() + k) % 3;
    const std::span<const Octant> octants = directory.octants();
    const auto is_deep = [](const Octant& octant) { return octant.level > OctantCells::max_fine_level; };
    if (std::ranges::none_of(octants, is_deep)) return;
    deep_origins.reserve(octants.size());
    for (const Octant& octant : octants) deep_origins.push_back(OctantCells::deep_origin(map, octant));
}

bool BatchEncoder::encode_scalar(std::span<const Box3f> boxes, std::uint32_t object, EncodedBatch& batch) const {
    std::array<Entry, max_encoded> entries;
    bool good = true;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        good &= is_box(boxes[i]);
        std::memcpy(&entries[i], &boxes[i], sizeof(Box3f));
        entries[i].object = object + std::uint32_t(i);
        entries[i].mask = 0;
    }
    encode_scalar(std::span<const Entry>(entries).first(boxes.size()), batch);
    return good;
}

void BatchEncoder::encode_scalar(std::span<const Entry> entries, EncodedBatch& batch) const {
    batch.crossers = 0;
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const CellBox cells = space_.cells(entries[i]);
        const Directory::Leaf leaf = directory_.leaf(cells.lo);
        batch.homes[i] = OctantCells(space_, directory_.octants()[leaf.octant()]).entry(entries[i]);
        batch.lists[i] = natural_level(cells) < leaf.level() ? no_list : leaf.octant();
        if (within(cells, leaf.level())) continue;
        const std::size_t crosser = batch.crossers++;
        batch.crosser[crosser] = std::uint32_t(i);
        batch.leaf[crosser] = leaf.element();
        for (unsigned axis = 0; axis < 3; ++axis) {
            batch.low[axis][crosser] = map.fine_cell(entries[i].min[axis], axis);
            batch.high[axis][crosser] = std::max(batch.low[axis][crosser], map.fine_cell(entries[i].max[axis], axis));
        }
    }
}

void BatchEncoder::ghosts_scalar(CrosserRange crossers, GhostGroup& group) {
    group.present = {};
    group.left_out = (1u << crossers.count) - 1;
}

}  // namespace octopair
