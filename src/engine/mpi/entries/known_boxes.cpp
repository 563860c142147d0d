#include "engine/mpi/entries/known_boxes.hpp"

#include <algorithm>
#include <utility>

namespace octopair {

KnownBoxes::KnownBoxes(const JointCall& call, const std::array<ObjectArrays, 2>& known, std::uint64_t most_postponed)
    : ForwardingSource(boxes_),
      tables_{PlaceTable(known[0].positions.span()), PlaceTable(known[1].positions.span())},
      second_begin_(call.join ? std::uint32_t(call.totals[0]) : 0),
      most_postponed_(most_postponed),
      first_(known[0].view()),
      second_(known[1].view()),
      boxes_(first_, call.join ? &second_ : nullptr, call.form) {}

KnownBoxes::PlaceTable::PlaceTable(std::span<const std::uint32_t> all) : positions(all) {
    constexpr std::size_t mean = 2;  // about the average number of positions for each element of `starts`
    if (all.empty()) return;
    base = all.front();
    const std::uint32_t range = all.back() - base;
    while ((range >> shift) > all.size() / mean + 1) ++shift;
    starts.assign(std::size_t(range >> shift) + 2, std::uint32_t(all.size()));
    for (auto place = std::uint32_t(all.size()); place-- > 0;) starts[(all[place] - base) >> shift] = place;
    // An element whose range has no positions gets the start of the next element, so its range of places is empty.
    for (std::size_t i = starts.size() - 1; i-- > 0;) starts[i] = std::min(starts[i], starts[i + 1]);
}

std::uint32_t KnownBoxes::PlaceTable::place(std::uint32_t position) const {
    const std::size_t at = std::size_t(position - base) >> shift;  // wraps to a large number before the base
    if (at + 1 >= starts.size()) throw MissingBounds{};
    const auto end = positions.begin() + starts[at + 1];
    const auto found = std::lower_bound(positions.begin() + starts[at], end, position);
    if (found == end || *found != position) throw MissingBounds{};
    return std::uint32_t(found - positions.begin());
}

/// Returns the number of an object among the known ones.
std::uint32_t KnownBoxes::place(std::uint32_t object) const {
    if (join() && object >= second_begin_)
        return std::uint32_t(tables_[0].positions.size()) + tables_[1].place(object - second_begin_);
    return tables_[0].place(object);
}

bool KnownBoxes::is_pair(std::uint32_t a, std::uint32_t b) const { return boxes_.is_pair(place(a), place(b)); }

std::size_t KnownBoxes::refused(const DoubtfulPairs& doubtful, std::uint32_t*) const {
    const std::lock_guard lock(mutex_);
    if (postponed_.size() + doubtful.size() > most_postponed_) throw MissingBounds{};
    for (std::size_t i = 0; i < doubtful.size(); ++i) postponed_.push_back({doubtful[i], &doubtful[i]});
    return 0;
}

std::vector<PostponedPair> KnownBoxes::take_postponed() const {
    const std::lock_guard lock(mutex_);
    return std::exchange(postponed_, {});
}

void KnownBoxes::load_bounds(std::span<Entry> entries) const {
    std::vector<std::uint32_t> objects;
    objects.reserve(entries.size());
    for (Entry& entry : entries) objects.push_back(std::exchange(entry.object, place(entry.object)));
    boxes_.load_bounds(entries);
    for (std::size_t i = 0; i < entries.size(); ++i) entries[i].object = objects[i];
}

}  // namespace octopair
