#include "engine/mpi/positioned_source.hpp"

#include <algorithm>

namespace octopair {

namespace {

constexpr std::size_t stride = 64;  // positions between milestones

}  // namespace

PositionedSource::PositionedSource(const BoxSource& boxes, const ObjectPositions& positions)
    : boxes_(boxes), positions_(positions) {
    for (unsigned set = 0; set < (join() ? 2 : 1); ++set) {
        const auto all = positions.of_set[set];
        milestones_[set].reserve(all.size() / stride + 1);
        for (std::size_t i = 0; i < all.size(); i += stride) milestones_[set].push_back(all[i]);
    }
}

bool PositionedSource::load(std::size_t begin, std::span<Entry> out) const {
    const bool good = boxes_.load(begin, out);
    const auto& [first, second] = positions_.of_set;
    for (std::size_t i = 0; i < out.size(); ++i) {
        const std::size_t place = begin + i;
        out[i].object = place < first.size() ? first[place] : positions_.second_begin + second[place - first.size()];
    }
    return good;
}

PlainBoxes PositionedSource::plain(std::size_t begin, std::size_t count) const {
    PlainBoxes plain = boxes_.plain(begin, count);
    plain.objects = positions_.of_set[0].data() + begin;
    return plain;
}

/// Returns the place of an object among the received objects.
std::uint32_t PositionedSource::place(std::uint32_t object) const {
    const bool in_second = join() && object >= positions_.second_begin;
    const std::uint32_t position = in_second ? object - positions_.second_begin : object;
    const auto positions = positions_.of_set[in_second];
    const auto& milestones = milestones_[in_second];
    const auto after = std::size_t(std::ranges::upper_bound(milestones, position) - milestones.begin());
    const auto near =
        positions.subspan((after - 1) * stride, std::min(stride, positions.size() - (after - 1) * stride));
    const auto at = std::ranges::lower_bound(near, position) - positions.begin();
    return std::uint32_t(std::size_t(at) + (in_second ? positions_.of_set[0].size() : 0));
}

void PositionedSource::load_bounds(std::span<Entry> entries) const {
    std::vector<std::uint32_t> objects(entries.size());
    for (std::size_t i = 0; i < entries.size(); ++i) {
        objects[i] = entries[i].object;
        entries[i].object = place(objects[i]);
    }
    boxes_.load_bounds(entries);
    for (std::size_t i = 0; i < entries.size(); ++i) entries[i].object = objects[i];
}

}  // namespace octopair
