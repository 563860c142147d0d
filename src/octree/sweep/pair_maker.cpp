#include "octree/sweep/pair_maker.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "base/stop.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "octree/sweep/start_order.hpp"

namespace octopair {

namespace {

bool oriented(const Entry& row, const Entry& column, const Orientation& orientation) {
    for (unsigned axis = 0; axis < 3; ++axis) {
        if (orientation[axis] > 0 && !comes_before(row, column, axis)) return false;
        if (orientation[axis] < 0 && !comes_before(column, row, axis)) return false;
    }
    return true;
}

/// Calls keep(row, column) for each bit of `hit` that is also in `asked`. Clears the bits for which keep() returns false.
template <typename Keep>
void filter(HitMask& hit, std::uint32_t asked, Keep&& keep) {
    for (; asked != 0; asked &= asked - 1) {
        if (!keep(hit.first_row() + unsigned(std::countr_zero(asked)), hit.column())) hit.keep(~(asked & -asked));
    }
}

}  // namespace

void PairMaker::sweep(const Sweep& sweep, const Orientation& orientation) {
    SweepCursor cursor;
    bool repeated = false;  // for Fault::sweep_repeats_block
    const std::span<HitMask> room = std::span(hits_).first(tuning().sweep.hits);
    const Depths depths = context_.source.exact() ? Depths{} : certain_depths(sweep, slack_);
    while (cursor.row < sweep.rows.size()) {
        const std::span<HitMask> hits = std::span(hits_).first(sweep_rows(sweep, cursor, room));
        if (orientation != Orientation{}) drop_turned(sweep, hits, orientation);
        if (!context_.source.exact()) drop_rounded(sweep, depths, hits);
        if (has_test_hooks && context_.outermost) check(sweep, hits);
        drain(sweep, hits);
        if (cursor.row < sweep.rows.size()) {
            count_path(Path::sweep_resumed);
            throw_if_stopped(context_.stop);
            if (planted(Fault::sweep_repeats_block) && !std::exchange(repeated, true)) cursor.in_row = false;
        }
    }
}

void PairMaker::drop_turned(const Sweep& sweep, std::span<HitMask> hits, const Orientation& orientation) {
    for (HitMask& hit : hits) {
        count_path(Path::hit_turned);
        filter(hit, hit.bits(), [&](std::size_t row, std::size_t column) {
            return oriented(sweep.rows.entry(row), sweep.columns.entry(column), orientation);
        });
    }
}

void PairMaker::drop_rounded(const Sweep& sweep, const Depths& depths, std::span<HitMask> hits) {
    const std::span<HitMask> certain = std::span(certain_).first(hits.size());
    std::copy(hits.begin(), hits.end(), certain.begin());
    keep_deep(sweep, depths, certain);
    for (std::size_t i = 0; i < hits.size(); ++i) {
        filter(hits[i], hits[i].bits() & ~certain[i].bits(), [&](std::size_t row, std::size_t column) {
            count_path(Path::hit_settled);
            return context_.source.is_pair(sweep.rows.object()[row], sweep.columns.object()[column]);
        });
    }
}

void PairMaker::check(const Sweep& sweep, std::span<const HitMask> hits) const {
    for (const HitMask& hit : hits) {
        const Entry column = sweep.columns.entry(hit.column());
        for (std::uint32_t bits = hit.bits(); bits != 0; bits &= bits - 1) {
            const std::size_t row = hit.first_row() + unsigned(std::countr_zero(bits));
            context_.outermost->check(sweep.rows.entry(row), column);
        }
    }
}

void PairMaker::drain(const Sweep& sweep, std::span<const HitMask> hits) {
    if (writer_.counting()) {
        count_path(Path::pairs_counted);
        std::uint64_t pairs = 0;
        for (const HitMask& hit : hits) pairs += std::uint64_t(std::popcount(hit.bits()));
        writer_.write_count(pairs);
        return;
    }
    while (!hits.empty()) {
        const std::size_t room = (tuning().sweep.pairs + max_hits - held_) / max_hits;
        const auto some = hits.first(std::min(hits.size(), room));
        held_ += pairs_of_hits(sweep, some, context_.source.second_begin(), pairs_.data() + held_);
        hits = hits.subspan(some.size());
        if (!hits.empty()) {
            count_path(Path::pairs_flushed);
            flush();
        }
    }
}

void PairMaker::flush() {
    if (held_ > 0) writer_.write(std::span(pairs_).first(held_));
    held_ = 0;
}

}  // namespace octopair
