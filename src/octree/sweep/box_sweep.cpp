#include "octree/sweep/box_sweep.hpp"

#include <algorithm>
#include <bit>
#include <limits>

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
void filter(BoxHits& hit, std::uint32_t asked, Keep&& keep) {
    for (; asked != 0; asked &= asked - 1) {
        if (!keep(hit.first_row() + unsigned(std::countr_zero(asked)), hit.column())) hit.keep(~(asked & -asked));
    }
}

}  // namespace

void BoxSet::assign(std::span<const Entry> entries, unsigned axis) {
    size_ = entries.size();
    stride_ = (size_ + padding + 15) / 16 * 16;
    axes_ = {axis, (axis + 1) % 3, (axis + 2) % 3};
    numbers_.resize_discard(6 * stride_);
    words_.resize_discard(2 * stride_);
    float* const numbers = numbers_.data();
    std::uint32_t* const words = words_.data();
    EntryArrays arrays{};
    for (unsigned k = 0; k < 3; ++k) {
        arrays[axes_[k]] = reinterpret_cast<std::uint32_t*>(numbers + k * stride_);
        arrays[3 + axes_[k]] = reinterpret_cast<std::uint32_t*>(numbers + (3 + k) * stride_);
    }
    arrays[6] = words + stride_;
    arrays[7] = words;
    split_entries(entries, arrays);
    // NaN compares false with everything, so padding ends each loop over columns and hits nothing. High ends on the sweep's
    // axis are padded with -infinity, because a block of rows takes their maximum.
    for (std::size_t k = 0; k < 6; ++k) {
        const float none = k == 3 ? -std::numeric_limits<float>::infinity() : std::numeric_limits<float>::quiet_NaN();
        std::fill(numbers + k * stride_ + size_, numbers + (k + 1) * stride_, none);
    }
    for (std::size_t i = size_; i < stride_; ++i) words[i] = words[stride_ + i] = 0;
}

Entry BoxSet::entry(std::size_t i) const {
    Entry entry;
    for (unsigned k = 0; k < 3; ++k) {
        entry.min[axes_[k]] = low(k)[i];
        entry.max[axes_[k]] = high(k)[i];
    }
    entry.mask = mask()[i];
    entry.object = object()[i];
    return entry;
}

void start_crossing_rows(const BoxSweep& sweep, BoxCursor& cursor) {
    const auto& [rows, columns, kind] = sweep;
    const float begin = rows.low(0)[cursor.row];
    const float* lows = columns.low(0);
    std::size_t& first = cursor.first_column;
    while (first < columns.size() && (kind == SweepKind::cross ? lows[first] < begin : lows[first] <= begin)) ++first;
    cursor.column = first / BoxSweep::column_group * BoxSweep::column_group;  // where registers are loaded
}

void BoxPairMaker::sweep(const BoxSweep& sweep, const Orientation& orientation) {
    const std::span<BoxHits> room = std::span(hits_).first(tuning().sweep.hits);
    const Depths depths = context_.source.exact() ? Depths{} : certain_depths(sweep, slack_);
    run_sweep(sweep, context_.stop, room, [&](std::span<BoxHits> hits) {
        if (orientation != Orientation{}) drop_turned(sweep, hits, orientation);
        if (!context_.source.exact()) drop_refused(sweep, depths, hits);
        if (has_test_hooks && context_.outermost) check(sweep, hits);
        write(sweep, hits);
    });
}

void BoxPairMaker::drop_turned(const BoxSweep& sweep, std::span<BoxHits> hits, const Orientation& orientation) {
    for (BoxHits& hit : hits) {
        count_path(Path::hit_turned);
        filter(hit, hit.bits(), [&](std::size_t row, std::size_t column) {
            return oriented(sweep.rows.entry(row), sweep.columns.entry(column), orientation);
        });
    }
}

void BoxPairMaker::drop_refused(const BoxSweep& sweep, const Depths& depths, std::span<BoxHits> hits) {
    const std::span<BoxHits> doubtful = std::span(doubtful_).first(hits.size());
    judge_hits(sweep, hits, depths, doubtful);
    for (std::size_t i = 0; i < hits.size(); ++i) {
        const std::uint32_t asked = doubtful[i].bits();
        if (asked == 0) continue;
        count_path(Path::hit_settled);
        const std::uint32_t* const rows = sweep.rows.object() + hits[i].first_row();
        const std::uint32_t column = sweep.columns.object()[hits[i].column()];
        hits[i].keep(~asked | context_.source.pairs_with(rows, column, asked));
    }
}

void BoxPairMaker::check(const BoxSweep& sweep, std::span<const BoxHits> hits) const {
    for (const BoxHits& hit : hits) {
        const Entry column = sweep.columns.entry(hit.column());
        for (std::uint32_t bits = hit.bits(); bits != 0; bits &= bits - 1) {
            const std::size_t row = hit.first_row() + unsigned(std::countr_zero(bits));
            context_.outermost->check(sweep.rows.entry(row), column);
        }
    }
}

void BoxPairMaker::write(const BoxSweep& sweep, std::span<const BoxHits> hits) {
    if (writer_.counting()) {
        count_path(Path::pairs_counted);
        std::uint64_t pairs = 0;
        for (const BoxHits& hit : hits) pairs += std::uint64_t(std::popcount(hit.bits()));
        writer_.write_count(pairs);
        return;
    }
    while (!hits.empty()) {
        const std::size_t room = (tuning().sweep.pairs + BoxHits::max_count - held_) / BoxHits::max_count;
        const auto some = hits.first(std::min(hits.size(), room));
        held_ += write_pairs(sweep, some, context_.source.second_begin(), pairs_.data() + held_);
        hits = hits.subspan(some.size());
        if (!hits.empty()) {
            count_path(Path::pairs_flushed);
            flush();
        }
    }
}

void BoxPairMaker::flush() {
    if (held_ > 0) writer_.write(std::span(pairs_).first(held_));
    held_ = 0;
}

}  // namespace octopair
