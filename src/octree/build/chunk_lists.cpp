#include "octree/build/chunk_lists.hpp"

#include <algorithm>

#include "base/tuning.hpp"
#include "octopair/error.hpp"

namespace octopair {

void ChunkLists::resize(std::size_t blocks, std::size_t lists, std::size_t max_entries_per_block) {
    blocks_ = blocks;
    lists_ = lists;
    // On average, half a chunk of each list stays unused. If there are many lists, smaller chunks limit the unused memory.
    chunk_size_ = tuning().build.max_chunk;
    while (chunk_size_ > min_chunk && lists * chunk_size_ * tuning().build.chunk_part > max_entries_per_block) {
        chunk_size_ /= 2;
    }
    constexpr std::size_t huge_page = (std::size_t(2) << 20) / sizeof(CellEntry);
    const std::size_t needed = max_entries_per_block + (lists + 1) * chunk_size_;
    const std::size_t unit = needed < huge_page ? chunk_size_ : huge_page;
    entries_per_block_ = (needed + unit - 1) / unit * unit;
    chunks_per_block_ = entries_per_block_ / chunk_size_;
    entries_.reserve_discard(blocks * entries_per_block_);
    next_.reserve_discard(blocks * chunks_per_block_);
    ends_.resize_discard(blocks * lists);
}

void ChunkLists::throw_damaged() { throw Error(ErrorCode::engine_failed, "the octree in shared memory is damaged"); }

ChunkWriter::ChunkWriter(ChunkLists& of, std::size_t block)
    : of_(of),
      block_(block),
      entries_(of.entries_.data() + block * of.entries_per_block_),
      next_(of.next_.data() + block * of.chunks_per_block_),
      in_chunk_(std::uint32_t(of.chunk_size_ - 1)),
      heads_(of.lists_ + 1, 0),
      firsts_(of.lists_, 0) {
    reset_discarded();
    (void)new_chunk(std::uint32_t(of.lists_), 1);
    chunks_ = 1;
}

std::uint32_t ChunkWriter::new_chunk(std::uint32_t list, std::uint32_t end) {
    if (chunks_ >= committed_) {
        constexpr std::size_t least = std::size_t(1) << 18, most = std::size_t(2) << 20;  // bytes
        const std::size_t chunk_bytes = of_.chunk_size_ * sizeof(CellEntry);
        const std::size_t bytes = of_.entries_per_block_ * sizeof(CellEntry) < 16 * most ? least : most;
        const std::size_t more =
            std::min(std::max<std::size_t>(bytes / chunk_bytes, 1), of_.chunks_per_block_ - committed_);
        of_.entries_.commit(block_ * of_.entries_per_block_ + committed_ * of_.chunk_size_, more * of_.chunk_size_);
        of_.next_.commit(block_ * of_.chunks_per_block_ + committed_, more);
        committed_ += more;
    }
    const std::uint32_t chunk = chunks_++;
    if (list < of_.lists_) {
        if (end == 0) {
            firsts_[list] = chunk;
        } else {
            next_[(end - 1) / of_.chunk_size_] = chunk;
        }
    }
    const CellEntry* const entries = entries_ + chunk * of_.chunk_size_;
    for (std::size_t line = 0; line < 2; ++line) prefetch(entries + 4 * line);
    return std::uint32_t(chunk * of_.chunk_size_);
}

void ChunkWriter::finish() {
    for (std::size_t list = 0; list < of_.lists_; ++list) {
        of_.ends_[block_ * of_.lists_ + list] = {firsts_[list], heads_[list]};
    }
}

StagedWriter::StagedWriter(ChunkLists& of, std::size_t block) : writer_(of, block) {
    const Tuning::Large& large = tuning().large;
    const std::size_t lists = of.lists() + 1;
    while (lists >> group_bits_ > large.max_groups) ++group_bits_;
    groups_.resize((lists >> group_bits_) + 1);
    chunk_size_ = large.stage_chunk;
    needed_ = groups_.size() + max_batch / chunk_size_;
    chunks_ = needed_ + lists * large.staged_per_list / chunk_size_;
    stage_.resize_discard(chunks_ * chunk_size_);
    next_.resize(chunks_);
}

void StagedWriter::add_chunk(Group& group) {
    const auto chunk = std::uint32_t(free_++);
    if (group.end == 0) {
        group.first = chunk;
    } else {
        next_[(group.end - 1) / chunk_size_] = chunk;
    }
    group.end = std::uint32_t(chunk * chunk_size_);
    group.chunk_end = group.end + std::uint32_t(chunk_size_);
}

void StagedWriter::flush() {
    for (Group& group : groups_) {
        if (group.end > 0) flush(group);
        group = {};
    }
    free_ = 0;
}

void StagedWriter::flush(const Group& group) {
    const std::size_t last = (group.end - 1) / chunk_size_;
    for (std::size_t chunk = group.first; chunk != last; chunk = next_[chunk]) {
        append_all(stage_.data() + chunk * chunk_size_, chunk_size_);
    }
    append_all(stage_.data() + last * chunk_size_, group.end - last * chunk_size_);
}

void StagedWriter::append_all(const StagedEntry* begin, std::size_t count) {
    constexpr std::size_t ahead = 16;
    for (std::size_t i = 0; i < count; ++i) {
        writer_.prefetch_end(begin[std::min(i + ahead, count - 1)].list);
        CellEntry entry;
        std::memcpy(&entry, begin[i].entry, sizeof entry);
        writer_.append(begin[i].list, entry);
        if (i % 8 == 7) writer_.reset_discarded();
    }
    writer_.reset_discarded();
}

void StagedWriter::finish() {
    flush();
    writer_.finish();
}

}  // namespace octopair
