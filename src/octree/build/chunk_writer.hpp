// ChunkWriter: appends the entries of one block of objects to ChunkLists.
#pragma once

#include <cstdint>
#include <vector>

#include "base/memory.hpp"
#include "octree/build/chunk_lists.hpp"

namespace octopair {

class ChunkWriter {
public:
    /// Borrows `of`. Replaces the entries that an earlier writer appended for the block.
    ChunkWriter(ChunkLists& of, std::size_t block);

    /// `list`: number of the list, or lists(), which discards the entry.
    void append(std::uint32_t list, const CellEntry& entry) {
        std::uint32_t at = heads_[list];
        if ((at & in_chunk_) == 0) [[unlikely]]
            at = new_chunk(list, at);
        // Prefetches the line behind that of the entry. Without this, the appends take three times as long.
        prefetch(entries_ + at + ahead);
        entries_[at] = entry;
        heads_[list] = at + 1;
    }
    /// Prefetches the line that the next entry of the list is written to.
    void prefetch_end(std::uint32_t list) const { prefetch(entries_ + heads_[list]); }
    /// Must be called after at most ChunkLists::min_chunk - 1 entries were discarded.
    void reset_discarded() { heads_[of_.lists_] = 1; }
    /// An entry is in its list as soon as it is appended: nothing is staged (StagedWriter).
    static constexpr bool full() { return false; }
    void flush() {}
    /// Makes the lists readable.
    void finish();

private:
    static constexpr std::size_t ahead = 5;
    std::uint32_t new_chunk(std::uint32_t list, std::uint32_t end);

    ChunkLists& of_;
    std::size_t block_;
    CellEntry* entries_;
    std::uint32_t* next_;
    std::uint32_t in_chunk_;
    std::vector<std::uint32_t> heads_, firsts_;  // by list: position behind the last entry; first chunk
    std::uint32_t chunks_ = 1;
    std::size_t committed_ = 0;  // chunks
};

}  // namespace octopair
