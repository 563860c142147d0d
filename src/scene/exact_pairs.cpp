#include "scene/exact_pairs.hpp"

#include <algorithm>
#include <functional>

#include "base/tuning.hpp"
#include "boxes/box_kernel.hpp"
#include "boxes/entry_source.hpp"
#include "engine/pair_list.hpp"

namespace octopair {

namespace {

/// Copies the candidates for which `is_pair` returns true to `out`. Returns the number of copied pairs.
template <typename IsPair>
std::size_t copy_pairs(std::span<const Pair> candidates, Pair* out, const IsPair& is_pair) {
    std::size_t count = 0;
    for (const Pair& pair : candidates) {
        out[count] = pair;
        count += is_pair(pair) ? 1 : 0;
    }
    return count;
}

/// Returns a function that copies those candidates whose own boxes are a pair. If there are no margin and no paddings, the function reads
/// the boxes only.
std::function<std::size_t(std::span<const Pair>, Pair*)> make_filter(const ObjectTable& table, double margin) {
    if (margin > 0 || table.any_padding()) {
        return [&table, margin](std::span<const Pair> candidates, Pair* out) {
            return copy_pairs(candidates, out, [&](const Pair& pair) {
                const double reach = margin + (table.padding(pair.a) + table.padding(pair.b));
                return within_reach(table.box(pair.a), table.box(pair.b), reach);
            });
        };
    }
    const auto of_boxes = [](auto boxes) {
        return [boxes](std::span<const Pair> candidates, Pair* out) {
            return copy_pairs(candidates, out, [&](const Pair& pair) { return overlap(boxes[pair.a], boxes[pair.b]); });
        };
    };
    if (table.precision() == Precision::float64) return of_boxes(table.own_boxes<double>());
    return of_boxes(table.own_boxes<float>());
}

}  // namespace

/// Divides the candidates into parts. Gives each part a piece of `room` that is as large as the part, for the pairs in it.
void ExactPairs::divide(const PairList& candidates, std::span<Pair> room) {
    parts_.clear();
    std::size_t begin = 0;
    for (std::span<const Pair> chunk : candidates.chunks()) {
        while (!chunk.empty()) {
            const auto some = chunk.first(std::min(chunk.size(), tuning().scene.exact_part));
            parts_.push_back({some, room.data() + begin});
            begin += some.size();
            chunk = chunk.subspan(some.size());
        }
    }
}

void ExactPairs::update(const PairList& candidates, const ObjectTable& table, double margin, PairChanges& changes) {
    detail::PairStorage& fresh = detail::storage_of(history_.fresh());
    fresh.reset();
    const std::span<Pair> room = fresh.take_block(std::size_t(candidates.size()));
    divide(candidates, room);
    const auto filter = make_filter(table, margin);
    const auto filter_part = [&](std::size_t i, unsigned) {
        parts_[i].count = filter(parts_[i].candidates, parts_[i].pairs);
    };
    team_.for_each(parts_.size(), std::ref(filter_part));
    Pair* end = room.data();
    for (const Part& part : parts_) end = std::move(part.pairs, part.pairs + part.count, end);
    fresh.append({room.data(), end});
    history_.take_over(changes);
}

}  // namespace octopair
