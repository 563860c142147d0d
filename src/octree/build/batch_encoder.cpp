#include <algorithm>

#include "octree/build/batch_encoder.hpp"

namespace octopair {

BatchEncoder::BatchEncoder(const Space& space, const Directory& directory, std::uint32_t no_list_number)
    : locator(space, directory), no_list(no_list_number), space_(space), directory_(directory) {
    for (unsigned k = 0; k < 3; ++k) axes[k] = (space.long_axis() + k) % 3;
    const std::span<const Octant> octants = directory.octants();
    const auto is_deep = [](const Octant& octant) { return octant.level > OctantCells::max_fine_level; };
    if (std::ranges::none_of(octants, is_deep)) return;
    deep_origins.reserve(octants.size());
    for (const Octant& octant : octants) deep_origins.push_back(OctantCells::deep_origin(locator.map, octant));
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
