#include "octree/sweep/cell_sweep.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "base/test_hooks.hpp"
#include "base/tuning.hpp"

namespace octopair {

void CellSet::turn() {
    turned_.assign(entries_.data(), entries_.data() + size_);
    for (CellEntry& entry : turned_) std::ranges::rotate(entry.ends, entry.ends.begin() + 1);
    const std::span<const CellEntry> run = turned_;
    assign({&run, 1});
}

void CellSet::assign(Runs runs) {
    size_ = 0;  // until all memory is allocated
    has_planes_ = false;
    std::size_t size = 0;
    for (const auto run : runs) size += run.size();
    entries_.resize_discard(size + entries_read_beyond);
    buckets_.resize(size);
    const unsigned max_bits = unsigned(std::bit_width(tuning().sweep.max_cell_buckets)) - 1;
    const unsigned bits = std::min({cell_bits, max_bits, unsigned(std::bit_width(size / 2))});
    bucket_shift_ = cell_bits - bits;
    bucket_begins_.assign((std::size_t(1) << bits) + 1, 0);
    size_ = size;
    const std::span<std::uint32_t> ends = std::span(bucket_begins_).subspan(1);
    std::uint16_t* bucket = buckets_.data();
    for (const auto run : runs) {
        for (const CellEntry& entry : run) {
            *bucket = std::uint16_t(entry.low(0) >> bucket_shift_);
            ++ends[*bucket++];
        }
    }
    std::uint32_t begin = 0;
    for (std::uint32_t& end : ends) begin += std::exchange(end, begin);
    bucket = buckets_.data();
    for (const auto run : runs) {
        for (const CellEntry& entry : run) entries_[ends[*bucket++]++] = entry;
    }
    std::fill_n(entries_.data() + size_, entries_read_beyond, CellEntry{{last_octant_cell << 16, 0, 0}, 0});
}

void CellSet::make_planes() {
    if (has_planes_) return;
    stride_ = size_ + bytes_read_beyond;
    planes_.resize_discard(cell_planes * stride_);
    write_planes({entries_.data(), size_}, planes_.data(), stride_);
    has_planes_ = true;
}

CellDepths certain_depths(const OctantCells& cells, const EntrySource& source) {
    CellDepths depths;
    if (planted(Fault::cell_depth_too_small)) return {.cells = {0, 0, 0}};
    if (source.exact()) return depths;
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
        const double needed =
            2 + std::ceil(std::ldexp(fine_cells, int(cells.level) - int(OctantCells::max_fine_level)));
        depths.none_certain |= !(needed <= last_octant_cell);
        depths.cells[k] = depths.none_certain ? std::uint16_t(last_octant_cell) : std::uint16_t(needed);
    }
    return depths;
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

CellPairMaker::CellPairMaker(const ScanContext& context, Memory& memory) : context_(context), memory_(memory) {
    const std::size_t room = tuning().sweep.cell_hits + judged_room;
    memory.hits.resize_discard(room);
    memory.pairs.resize_discard(room);
    memory.doubtful.resize_discard(room);
    memory.refused.resize_discard(room);
}

void CellPairMaker::sweep(const CellSweep& sweep, const CellDepths& depths, ShareWriter& writer) {
    const std::uint32_t second_begin = context_.source.second_begin();
    const std::span<CellHit> room = memory_.hits.span().first(memory_.hits.size() - judged_room);
    run_sweep(sweep, context_.stop, room, [&](std::span<CellHit> hits) {
        std::span<Pair> room_for_pairs = writer.counting() ? std::span<Pair>() : writer.room(hits.size() + judged_room);
        if (room_for_pairs.empty()) room_for_pairs = memory_.pairs.span();
        JudgedHits judged{.pairs = room_for_pairs.data(), .doubtful = memory_.doubtful.data()};
        judge_hits(sweep, hits, depths, judged);
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
    });
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
