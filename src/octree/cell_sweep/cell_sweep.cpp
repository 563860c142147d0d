#include "octree/cell_sweep/cell_sweep.hpp"

#include <algorithm>
#include <cmath>

#include "base/test_hooks.hpp"
#include "base/tuning.hpp"

namespace octopair {

CertainGaps certain_gaps(const OctantCells& cells, const PairRule& rule) {
    CertainGaps gaps;
    if (planted(Fault::cell_gap_too_small)) return {.cells = {0, 0, 0}};
    if (rule.exact()) return gaps;
    const RoundingSlack slack = rule.slack();
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

/// True if a row and a column overlap in the bits of their columns.
bool overlap(const CellSet& rows, std::size_t row, const CellSet& columns, std::size_t column) {
    const auto byte = [](std::uint32_t word, unsigned i) { return word >> 8 * i & 0xFFu; };
    const auto low = [](std::uint32_t ends) { return ends & 0xFFFFu; };
    const auto high = [](std::uint32_t ends) { return ends >> 16 ^ 0xFFFFu; };
    const std::uint32_t a = rows.first_axis()[row], b = columns.first_axis()[column];
    bool overlaps = low(b) <= high(a) && low(a) <= high(b);
    const std::uint32_t others_a = rows.other_axes()[row], others_b = columns.other_axes()[column];
    for (const unsigned axis : {0u, 2u}) {
        overlaps &= byte(others_b, axis) <= (byte(others_a, axis + 1) ^ 0xFFu);
        overlaps &= byte(others_a, axis) <= (byte(others_b, axis + 1) ^ 0xFFu);
    }
    return overlaps;
}

}  // namespace

bool start_crossing_rows(const CellSweep& sweep, CellCursor& cursor) {
    const std::uint32_t* const columns = sweep.columns.first_axis();
    const std::uint32_t begin = first_tested(sweep, cursor.row);
    std::size_t& first = cursor.first_column;
    while (first < sweep.columns.size() && (columns[first] & 0xFFFFu) < begin) ++first;
    cursor.column = first;
    return first < sweep.columns.size();
}

std::size_t cell_hits_scalar(const CellSweep& sweep, CellCursor& cursor, std::span<CellHit> hits) {
    const auto& [rows, columns, kind] = sweep;
    std::size_t written = 0;
    for (; cursor.row < rows.size(); cursor.row += row_block, cursor.in_row = false) {
        if (!start_rows(sweep, cursor)) {
            cursor.row = rows.size();
            break;
        }
        const std::uint32_t reach = block_reach(sweep, cursor.row);
        for (; (columns.first_axis()[cursor.column] & 0xFFFFu) <= reach; cursor.column += column_group) {
            if (written + row_block * column_group > hits.size()) return written;
            for (std::size_t row = cursor.row; row < cursor.row + row_block; ++row) {
                for (std::size_t column = cursor.column; column < cursor.column + column_group; ++column) {
                    const std::uint32_t begin = columns.first_axis()[column] & 0xFFFFu;
                    if (kind == SweepKind::self ? column <= row : begin < first_tested(sweep, row)) continue;
                    if (overlap(rows, row, columns, column)) hits[written++] = CellHit(row << 16 | column);
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
        bool apart = share_flag(row, column), certain = !gaps.none_certain;
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
    const auto& [rows, columns, kind] = sweep;
    std::uint64_t sum = 0;
    std::size_t samples = 0;
    const std::size_t stride = tuning().sweep.measured_row_stride;
    for (std::size_t i = 0; i < rows.size(); i += stride, ++samples) {
        const CellEntry& row = rows.entries()[i];
        const std::uint64_t end = columns.bucket_end(row.high(0));
        const std::uint32_t bucket = row.low(0) >> columns.bucket_shift();
        const std::uint64_t begin = kind == SweepKind::self ? i + 1
                                    : bucket == 0           ? 0
                                                  : columns.bucket_end((bucket - 1) << columns.bucket_shift());
        sum += end - std::min(begin, end);
    }
    return samples == 0 ? 0 : sum * rows.size() / samples;
}

}  // namespace octopair
