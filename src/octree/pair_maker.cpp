#include "octree/pair_maker.hpp"

#include <algorithm>
#include <bit>

#include "base/stop.hpp"

namespace octopair {

namespace {

bool comes_before(const Entry& a, const Entry& b, unsigned axis) {
    return a.min[axis] != b.min[axis] ? a.min[axis] < b.min[axis] : a.object < b.object;
}

bool oriented(const Entry& row, const Entry& column, const Orientation& orientation) {
    for (unsigned axis = 0; axis < 3; ++axis) {
        if (orientation[axis] > 0 && !comes_before(row, column, axis)) return false;
        if (orientation[axis] < 0 && !comes_before(column, row, axis)) return false;
    }
    return true;
}

}  // namespace

void PairMaker::sweep(const Sweep& sweep, const Orientation& orientation) {
    SweepCursor cursor;
    cursor.row_end = sweep.rows.size();
    while (cursor.row < cursor.row_end) {
        const std::size_t count = sweep_rows(sweep, cursor, hits_);
        drain(sweep, std::span(hits_).first(count), orientation);
        if (cursor.row < cursor.row_end) throw_if_stopped(context_.stop);
    }
}

void PairMaker::drain(const Sweep& sweep, std::span<const HitMask> hits, const Orientation& orientation) {
    const SweepSet& rows = sweep.rows;
    const SweepSet& columns = sweep.columns;
    const bool plain = context_.source.exact() && orientation == Orientation{};
    if (plain && writer_.counting()) {
        std::uint64_t pairs = 0;
        for (const HitMask& hit : hits) pairs += std::uint64_t(std::popcount(hit.bits));
        writer_.write_count(pairs);
        return;
    }
    for (const HitMask& hit : hits) {
        for (std::uint32_t bits = hit.bits; bits != 0; bits &= bits - 1) {
            const std::size_t column = hit.first + unsigned(std::countr_zero(bits));
            if (plain) {
                add(rows.object(hit.row), columns.object(column));
            } else {
                add(rows.entry(hit.row), columns.entry(column), orientation);
            }
        }
    }
}

void PairMaker::add(const Entry& row, const Entry& column, const Orientation& orientation) {
    const BoxSource& source = context_.source;
    if (!oriented(row, column, orientation)) return;
    if (source.exact() || source.certain(row, column) || source.counts(row.object, column.object)) {
        add(row.object, column.object);
    }
}

void PairMaker::add(std::uint32_t row, std::uint32_t column) {
    if (held_ == pairs_.size()) flush();
    pairs_[held_++] = {std::min(row, column), std::max(row, column) - context_.source.second_begin()};
}

void PairMaker::flush() {
    if (held_ == 0) return;
    if (writer_.counting()) {
        writer_.write_count(held_);
    } else {
        writer_.write(std::span(pairs_).first(held_));
    }
    held_ = 0;
}

}  // namespace octopair
