#include "octree/sweep/cell_pair_maker.hpp"

#include <algorithm>
#include <array>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"

namespace octopair {

CellPairMaker::CellPairMaker(const ScanContext& context, Memory& memory) : context_(context), memory_(memory) {
    const std::size_t room = tuning().sweep.cell_hits + judged_room;
    memory.hits.resize_discard(room);
    memory.pairs.resize_discard(room);
    memory.doubtful.resize_discard(room);
    memory.refused.resize_discard(room);
}

void CellPairMaker::sweep(const CellSweep& sweep, const CertainGaps& gaps, ShareWriter& writer) {
    CellCursor cursor;
    const std::uint32_t second_begin = context_.source.second_begin();
    const std::span<CellHit> room = memory_.hits.span().first(memory_.hits.size() - judged_room);
    while (cursor.row < sweep.rows.size()) {
        const std::span<CellHit> hits = room.first(cell_hits(sweep, cursor, room));
        std::span<Pair> room_for_pairs = writer.counting() ? std::span<Pair>() : writer.room(hits.size() + judged_room);
        if (room_for_pairs.empty()) room_for_pairs = memory_.pairs.span();
        JudgedHits judged{.pairs = room_for_pairs.data(), .doubtful = memory_.doubtful.data()};
        judge_hits(sweep, hits, gaps, judged);
        const std::span<Pair> pairs = room_for_pairs.first(drop_refused(judged));
        if (has_test_hooks && context_.outermost) check(pairs);
        if (writer.counting()) {
            count_path(Path::pairs_counted);
            writer.write_count(pairs.size());
        } else if (!pairs.empty()) {
            if (second_begin > 0) {
                for (Pair& pair : pairs) pair.b -= second_begin;
            }
            writer.write(pairs);
        }
        if (cursor.row < sweep.rows.size()) {
            count_path(Path::cell_sweep_resumed);
            throw_if_stopped(context_.stop);
        }
    }
}

/// Removes the doubtful pairs that the pair rule refuses. Returns the number of pairs left.
std::size_t CellPairMaker::drop_refused(JudgedHits& judged) {
    if (judged.doubtful_count == 0) return judged.pair_count;
    count_path(Path::cell_hit_doubtful);
    const std::span<const Pair> pairs{judged.pairs, judged.pair_count};
    const std::span<const std::uint32_t> doubtful{judged.doubtful, judged.doubtful_count};
    const auto refused =
        memory_.refused.span().first(context_.source.refused({pairs, doubtful}, memory_.refused.data()));
    if (refused.empty()) return pairs.size();
    count_path(Path::cell_hit_refused);
    Pair* at = judged.pairs + refused.front();
    for (std::size_t i = 0; i < refused.size(); ++i) {
        const std::size_t end = i + 1 < refused.size() ? refused[i + 1] : pairs.size();
        at = std::copy(judged.pairs + refused[i] + 1, judged.pairs + end, at);
    }
    return std::size_t(at - judged.pairs);
}

void CellPairMaker::check(std::span<const Pair> pairs) const {
    for (const Pair& pair : pairs) {
        std::array<Entry, 2> entries;
        entries[0].object = pair.a;
        entries[1].object = pair.b;
        context_.source.load_bounds(entries);
        context_.outermost->check(entries[0], entries[1]);
    }
}

}  // namespace octopair
