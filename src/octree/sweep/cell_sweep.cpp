#include "octree/sweep/cell_sweep.hpp"

#include <algorithm>
#include <cmath>

#include "base/test_hooks.hpp"
#include "base/tuning.hpp"

namespace octopair {

CertainGaps certain_gaps(const OctantCells& cells, const EntrySource& source) {
    CertainGaps gaps;
    if (planted(Fault::cell_gap_too_small)) return {.cells = {0, 0, 0}};
    if (source.exact()) return gaps;
    const RoundingSlack slack = source.slack();
    for (unsigned k = 0; k < 3; ++k) {
        const unsigned axis = cells.axes[k];
        const double scale = double(cells.map.scale[axis]), origin = double(cells.map.origin[axis]);
        const double begin = cells.first[axis], end = begin + cells.last_offset + 1;
        const double largest = std::max(std::abs(origin + begin / scale), std::abs(origin + end / scale));
        // A depth (boxes/entry.hpp) is more than twice the error of two bounds. The map to fine cells rounds by up to a fine
        // cell, and its float32 operations add an error. In a deep octant both errors are far below a cell.
        const double depth = 2 * largest * double(RoundingSlack::part) + double(slack.base[axis]);
        const double mapping = cells.is_deep() ? 0 : 1 + end * 0x1p-21;
        const double fine_cells = mapping + depth / 2 * scale;
        const double gap = 2 + std::ceil(std::ldexp(fine_cells, int(cells.level) - int(OctantCells::max_fine_level)));
        gaps.none_certain |= !(gap <= last_octant_cell);
        gaps.cells[k] = gaps.none_certain ? std::uint16_t(last_octant_cell) : std::uint16_t(gap);
    }
    return gaps;
}

namespace {

/// True if a row and a column overlap in the bytes of their planes.
bool overlap(const CellEntry& row, const CellEntry& column) {
    const auto [low1, high1, low2, high2] = plane_bytes(row);
    const auto [column_low1, column_high1, column_low2, column_high2] = plane_bytes(column);
    return column_low1 <= high1 && low1 <= column_high1 && column_low2 <= high2 && low2 <= column_high2;
}

}  // namespace

std::size_t cell_hits_scalar(const CellSweep& sweep, CellCursor& cursor, std::span<CellHit> hits) {
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
        for (; cursor.column < end; cursor.column += column_group) {
            if (written + block * column_group > hits.size()) return written;
            for (std::size_t row = cursor.row; row < block_end; ++row) {
                const std::size_t group_end = std::min(cursor.column + column_group, windows.end(row));
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

void judge_hits_scalar(const CellSweep& sweep, std::span<CellHit> hits, const CertainGaps& gaps, JudgedHits& judged) {
    for (const CellHit hit : hits) {
        const CellEntry& row = sweep.rows.entries()[hit >> 16];
        const CellEntry& column = sweep.columns.entries()[hit & 0xFFFFu];
        bool apart = !reports(row, column), certain = !gaps.none_certain;
        for (unsigned k = 0; k < 3; ++k) {
            const int depth = std::min(int(row.high(k)) - int(column.low(k)), int(column.high(k)) - int(row.low(k)));
            apart |= depth < 0;
            certain &= depth >= int(gaps.cells[k]);
        }
        if (apart) continue;
        if (!certain) judged.doubtful[judged.doubtful_count++] = std::uint32_t(judged.pair_count);
        judged.pairs[judged.pair_count++] = {std::min(row.object, column.object), std::max(row.object, column.object)};
    }
}

std::uint64_t sampled_tests(const CellSweep& sweep) {
    const CellWindows windows(sweep);
    std::uint64_t sum = 0;
    std::size_t samples = 0;
    const std::size_t rows = sweep.rows.size();
    for (std::size_t row = 0; row < rows; row += tuning().sweep.measured_row_stride, ++samples) {
        const std::size_t begin = windows.begin(row);
        sum += std::max(windows.end(row), begin) - begin;
    }
    return samples == 0 ? 0 : sum * rows / samples;
}

}  // namespace octopair
