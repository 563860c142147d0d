#include "octree/sweep/sweep.hpp"

#include <algorithm>
#include <limits>

#include "base/tuning.hpp"

namespace octopair {

namespace {

/// True if a sweep of this kind must test the row against the column, and if their boxes overlap and their masks share no bit.
bool hit(const Sweep& sweep, std::size_t row, std::size_t column) {
    const auto& [rows, columns, kind] = sweep;
    if (kind == SweepKind::self && column <= row) return false;
    if (kind == SweepKind::cross && !(columns.low(0)[column] >= rows.low(0)[row])) return false;
    if (kind == SweepKind::cross_strict && !(columns.low(0)[column] > rows.low(0)[row])) return false;
    bool hits = columns.low(0)[column] <= rows.high(0)[row] && reports(rows.mask()[row], columns.mask()[column]);
    for (unsigned axis = 1; axis < 3; ++axis) {
        hits &= rows.low(axis)[row] <= columns.high(axis)[column] && columns.low(axis)[column] <= rows.high(axis)[row];
    }
    return hits;
}

}  // namespace

void SweepSet::assign(std::span<const Entry> entries, unsigned axis) {
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

Entry SweepSet::entry(std::size_t i) const {
    Entry entry;
    for (unsigned k = 0; k < 3; ++k) {
        entry.min[axes_[k]] = low(k)[i];
        entry.max[axes_[k]] = high(k)[i];
    }
    entry.mask = mask()[i];
    entry.object = object()[i];
    return entry;
}

void start_crossing_rows(const Sweep& sweep, SweepCursor& cursor) {
    const auto& [rows, columns, kind] = sweep;
    const float begin = rows.low(0)[cursor.row];
    const float* lows = columns.low(0);
    std::size_t& first = cursor.first_column;
    while (first < columns.size() && (kind == SweepKind::cross ? lows[first] < begin : lows[first] <= begin)) ++first;
    cursor.column = first / max_columns * max_columns;  // registers are loaded from multiples of max_columns
}

std::size_t sweep_rows_scalar(const Sweep& sweep, SweepCursor& cursor, std::span<HitMask> hits) {
    const SweepSet& rows = sweep.rows;
    const SweepSet& columns = sweep.columns;
    std::size_t written = 0;
    for (std::size_t tests = 0; cursor.row < rows.size(); cursor.row += block_size, cursor.in_row = false) {
        start_rows(sweep, cursor);
        const std::size_t rows_end = std::min(cursor.row + block_size, rows.size());
        const float reach = *std::max_element(rows.high(0) + cursor.row, rows.high(0) + rows_end);
        for (; cursor.column < columns.size() && columns.low(0)[cursor.column] <= reach; ++cursor.column) {
            if (written == hits.size() || ++tests > tuning().sweep.tests_per_call) return written;
            std::uint32_t bits = 0;
            for (std::size_t row = cursor.row; row < rows_end; ++row) {
                bits |= std::uint32_t(hit(sweep, row, cursor.column)) << (row - cursor.row);
            }
            if (bits != 0) hits[written++] = HitMask(std::uint32_t(cursor.column), cursor.row, bits);
        }
    }
    return written;
}

}  // namespace octopair
