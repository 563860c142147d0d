#include "octree/build/staged_writer.hpp"

#include <algorithm>

#include "base/tuning.hpp"

namespace octopair {

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
