#include "octree/sweep.hpp"

#include <limits>

namespace octopair {

namespace {

constexpr std::size_t tests_per_call = std::size_t(1) << 22;  // a few milliseconds: then the caller looks for a stop

bool hit(const SweepSet& rows, std::size_t row, const SweepSet& columns, std::size_t column) {
    for (unsigned axis = 1; axis < 3; ++axis) {
        if (!(rows.low(axis)[row] <= columns.high(axis)[column] && columns.low(axis)[column] <= rows.high(axis)[row])) {
            return false;
        }
    }
    return (rows.mask()[row] & columns.mask()[column]) == 0;
}

}  // namespace

void SweepSet::assign(std::span<const Entry> entries, std::span<const SortKey> order, unsigned axis) {
    size_ = order.size();
    stride_ = (size_ + padding + 15) / 16 * 16;
    axes_ = {axis, (axis + 1) % 3, (axis + 2) % 3};
    numbers_.resize_discard(6 * stride_);
    words_.resize_discard(2 * stride_);
    float* const numbers = numbers_.data();
    std::uint32_t* const words = words_.data();
    for (std::size_t i = 0; i < size_; ++i) {
        const Entry& entry = entries[position_of(order[i])];
        for (unsigned k = 0; k < 3; ++k) {
            numbers[k * stride_ + i] = entry.min[axes_[k]];
            numbers[(3 + k) * stride_ + i] = entry.max[axes_[k]];
        }
        words[i] = entry.mask;
        words[stride_ + i] = entry.object;
    }
    // NaN compares false with everything: neither ends a row's columns late nor hits.
    for (std::size_t k = 0; k < 6; ++k) {
        for (std::size_t i = size_; i < stride_; ++i)
            numbers[k * stride_ + i] = std::numeric_limits<float>::quiet_NaN();
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

void start_crossing_row(const Sweep& sweep, SweepCursor& cursor) {
    const auto& [rows, columns, kind] = sweep;
    const float begin = rows.low(0)[cursor.row];
    const float* lows = columns.low(0);
    std::size_t& first = cursor.first_column;
    while (first < columns.size() && (kind == SweepKind::cross ? lows[first] < begin : lows[first] <= begin)) ++first;
    cursor.column = first;
}

std::size_t sweep_rows_scalar(const Sweep& sweep, SweepCursor& cursor, std::span<HitMask> hits) {
    const SweepSet& rows = sweep.rows;
    const SweepSet& columns = sweep.columns;
    std::size_t written = 0;
    for (std::size_t tests = 0; cursor.row < cursor.row_end; ++cursor.row, cursor.in_row = false) {
        start_row(sweep, cursor);
        const float end = rows.high(0)[cursor.row];
        for (; cursor.column < columns.size() && columns.low(0)[cursor.column] <= end; ++cursor.column) {
            if (written == hits.size() || ++tests > tests_per_call) return written;
            if (!hit(rows, cursor.row, columns, cursor.column)) continue;
            hits[written++] = {std::uint32_t(cursor.row), std::uint32_t(cursor.column), 1};
        }
    }
    return written;
}

}  // namespace octopair
