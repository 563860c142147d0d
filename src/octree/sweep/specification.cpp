// The specification of the SIMD versions of both sweeps: what they must find, and in which order. Tests compare them with it. A search
// runs it only on a processor without SIMD.

#include <algorithm>
#include <array>

#include "base/tuning.hpp"
#include "octree/sweep/box_sweep.hpp"
#include "octree/sweep/cell_sweep.hpp"

namespace octopair {

namespace {

/// True if a row and a column overlap in the bytes of their planes.
bool overlap(const CellEntry& row, const CellEntry& column) {
    const auto [low1, high1, low2, high2] = plane_bytes(row);
    const auto [column_low1, column_high1, column_low2, column_high2] = plane_bytes(column);
    return column_low1 <= high1 && low1 <= column_high1 && column_low2 <= high2 && low2 <= column_high2;
}

/// True if a sweep of this kind must test the row against the column, and if their boxes overlap and their masks share no bit.
bool hit(const BoxSweep& sweep, std::size_t row, std::size_t column) {
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

std::array<std::uint8_t, cell_planes> plane_bytes(const CellEntry& entry) {
    constexpr unsigned dropped_bits = cell_bits - 8;
    const auto byte = [](std::uint32_t cell) { return std::uint8_t(cell >> dropped_bits); };
    return {byte(entry.low(1)), byte(entry.high(1)), byte(entry.low(2)), byte(entry.high(2))};
}

std::size_t find_hits_scalar(const CellSweep& sweep, CellCursor& cursor, std::span<CellHit> hits) {
    const auto& [rows, columns, kind, ahead] = sweep;
    const CellWindows windows(sweep);
    const std::size_t block = sweep.block();
    std::size_t written = 0;
    for (; cursor.row < rows.size(); cursor.row += block, cursor.in_row = false) {
        const std::size_t block_end = std::min(cursor.row + block, rows.size());
        std::size_t end = 0;
        for (std::size_t row = cursor.row; row < block_end; ++row) end = std::max(end, windows.end(row));
        if (!cursor.in_row) cursor.column = windows.begin(cursor.row);
        cursor.in_row = true;
        for (; cursor.column < end; cursor.column += CellSweep::column_group) {
            if (written + block * CellSweep::column_group > hits.size()) return written;
            for (std::size_t row = cursor.row; row < block_end; ++row) {
                const std::size_t group_end = std::min(cursor.column + CellSweep::column_group, windows.end(row));
                for (std::size_t column = std::max(cursor.column, windows.begin(row)); column < group_end; ++column) {
                    if (overlap(rows.entries()[row], columns.entries()[column])) {
                        hits[written++] = CellHit(row << 16 | column);
                    }
                }
            }
        }
    }
    return written;
}

void judge_hits_scalar(const CellSweep& sweep, std::span<CellHit> hits, const CellDepths& depths, JudgedHits& judged) {
    for (const CellHit hit : hits) {
        const CellEntry& row = sweep.rows.entries()[hit >> 16];
        const CellEntry& column = sweep.columns.entries()[hit & 0xFFFFu];
        bool apart = !reports(row, column), certain = !depths.none_certain;
        for (unsigned k = 0; k < 3; ++k) {
            const int depth = std::min(int(row.high(k)) - int(column.low(k)), int(column.high(k)) - int(row.low(k)));
            apart |= depth < 0;
            certain &= depth >= int(depths.cells[k]);
        }
        if (apart) continue;
        if (!certain) judged.doubtful[judged.doubtful_count++] = std::uint32_t(judged.pair_count);
        judged.pairs[judged.pair_count++] = {std::min(row.object, column.object), std::max(row.object, column.object)};
    }
}

std::size_t find_hits_scalar(const BoxSweep& sweep, BoxCursor& cursor, std::span<BoxHits> hits) {
    const BoxSet& rows = sweep.rows;
    const BoxSet& columns = sweep.columns;
    std::size_t written = 0;
    for (std::size_t tests = 0; cursor.row < rows.size(); cursor.row += BoxSweep::row_block, cursor.in_row = false) {
        start_rows(sweep, cursor);
        const std::size_t rows_end = std::min(cursor.row + BoxSweep::row_block, rows.size());
        const float reach = *std::max_element(rows.high(0) + cursor.row, rows.high(0) + rows_end);
        for (; cursor.column < columns.size() && columns.low(0)[cursor.column] <= reach; ++cursor.column) {
            if (written == hits.size() || ++tests > tuning().sweep.tests_per_call) return written;
            std::uint32_t bits = 0;
            for (std::size_t row = cursor.row; row < rows_end; ++row) {
                bits |= std::uint32_t(hit(sweep, row, cursor.column)) << (row - cursor.row);
            }
            if (bits != 0) hits[written++] = BoxHits(std::uint32_t(cursor.column), cursor.row, bits);
        }
    }
    return written;
}

}  // namespace octopair
