#include "engine/mpi/positioned_source.hpp"

#include <algorithm>
#include <numeric>

#include "base/memory.hpp"

namespace octopair {

void PositionedSource::PlaceTable::fill(std::span<const std::uint32_t> positions) {
    constexpr std::size_t mean = 2;  // average number of positions for each element of `starts`
    if (positions.empty()) return;
    base = positions.front();
    const std::uint64_t range = std::uint64_t(positions.back()) - base + 1;
    while ((range >> shift) > positions.size() / mean + 1) ++shift;
    starts.assign(std::size_t(range >> shift) + 2, std::uint32_t(positions.size()));
    for (auto place = std::uint32_t(positions.size()); place-- > 0;) starts[(positions[place] - base) >> shift] = place;
    // An element whose range has no positions gets the start of the next element, so its range of places is empty.
    for (std::size_t i = starts.size() - 1; i-- > 0;) starts[i] = std::min(starts[i], starts[i + 1]);
}

PositionedSource::PositionedSource(const BoxSource& boxes, const ObjectPositions& positions)
    : ForwardingSource(boxes), positions_(positions) {
    for (unsigned set = 0; set < (join() ? 2 : 1); ++set) tables_[set].fill(positions.of_set[set]);
}

bool PositionedSource::load(std::size_t begin, std::span<Entry> out) const {
    const bool good = source().load(begin, out);
    const auto& [first, second] = positions_.of_set;
    for (std::size_t i = 0; i < out.size(); ++i) {
        const std::size_t place = begin + i;
        out[i].object = place < first.size() ? first[place] : positions_.second_begin + second[place - first.size()];
    }
    return good;
}

Float32Boxes PositionedSource::float32_boxes(std::size_t begin, std::span<Box3f> room) const {
    Float32Boxes boxes = source().float32_boxes(begin, room);
    boxes.objects = positions_.of_set[0].data() + begin;
    return boxes;
}

/// Returns the set that an object belongs to, and its position within that set.
PositionedSource::Named PositionedSource::named(std::uint32_t object) const {
    const bool in_second = join() && object >= positions_.second_begin;
    return {in_second ? 1u : 0u, in_second ? object - positions_.second_begin : object};
}

/// Returns the place of an object among the received objects.
std::uint32_t PositionedSource::place(std::uint32_t object) const {
    const auto [set, position] = named(object);
    const auto positions = positions_.of_set[set];
    const std::uint32_t* const start = tables_[set].start(position);
    const auto at = std::lower_bound(positions.begin() + start[0], positions.begin() + start[1], position);
    return std::uint32_t(std::size_t(at - positions.begin()) + (set == 1 ? positions_.of_set[0].size() : 0));
}

/// Replaces objects by their places. First prefetches, for all objects, the table elements and positions that place() reads. So the
/// look-ups wait for memory at the same time, not one after another.
void PositionedSource::find_places(std::span<std::uint32_t> objects) const {
    for (const std::uint32_t object : objects) {
        const auto [set, position] = named(object);
        prefetch(tables_[set].start(position));
    }
    for (const std::uint32_t object : objects) {
        const auto [set, position] = named(object);
        prefetch(positions_.of_set[set].data() + *tables_[set].start(position));
    }
    for (std::uint32_t& object : objects) object = place(object);
}

std::size_t PositionedSource::refused(const DoubtfulPairs& doubtful, std::uint32_t* out) const {
    constexpr std::size_t most = 256;  // pairs at a time
    std::array<std::uint32_t, 2 * most> places;
    std::array<Pair, most> pairs;
    std::array<std::uint32_t, most> numbers, refused;
    std::iota(numbers.begin(), numbers.end(), 0u);
    std::size_t count = 0;
    for (std::size_t begin = 0; begin < doubtful.size(); begin += most) {
        const std::size_t some = std::min(most, doubtful.size() - begin);
        for (std::size_t i = 0; i < some; ++i) {
            places[2 * i] = doubtful[begin + i].a;
            places[2 * i + 1] = doubtful[begin + i].b;
        }
        find_places(std::span(places).first(2 * some));
        for (std::size_t i = 0; i < some; ++i) pairs[i] = {places[2 * i], places[2 * i + 1]};
        const std::size_t refused_here =
            source().refused({std::span(pairs).first(some), std::span(numbers).first(some)}, refused.data());
        for (std::size_t i = 0; i < refused_here; ++i) out[count++] = doubtful.positions[begin + refused[i]];
    }
    return count;
}

void PositionedSource::load_bounds(std::span<Entry> entries) const {
    std::vector<std::uint32_t> objects(entries.size()), places(entries.size());
    for (std::size_t i = 0; i < entries.size(); ++i) objects[i] = places[i] = entries[i].object;
    constexpr std::size_t most = 512;  // objects at a time, so that what is prefetched stays in the L1 cache
    for (std::size_t i = 0; i < places.size(); i += most)
        find_places(std::span(places).subspan(i, std::min(most, places.size() - i)));
    for (std::size_t i = 0; i < entries.size(); ++i) entries[i].object = places[i];
    source().load_bounds(entries);
    for (std::size_t i = 0; i < entries.size(); ++i) entries[i].object = objects[i];
}

}  // namespace octopair
