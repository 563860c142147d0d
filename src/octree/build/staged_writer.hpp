// StagedWriter: appends the entries of one block of objects to very many lists of ChunkLists.
//
// A ChunkWriter writes each entry to the end of its list. If there are more lists than the caches and the TLB hold the ends of,
// almost each write waits for memory. A StagedWriter distributes entries in two passes, as an MSD radix sort does: first to
// groups of adjacent lists, then group by group to the lists. Each pass writes to a few hundred places.
//
// Invariants
//   The entries of a list stay in the order in which they are appended.
//   The stage has a fixed size. When it is nearly full, all its entries go to their lists.
//
// Source: Manegold, Boncz, Kersten 2002, "Optimizing main-memory join on modern hardware" (radix cluster in several passes).
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "base/memory.hpp"
#include "octree/build/chunk_lists.hpp"

namespace octopair {

class StagedWriter {
public:
    /// Borrows `of`. Replaces the entries that an earlier writer appended for the block.
    StagedWriter(ChunkLists& of, std::size_t block);

    /// `list`: number of the list, or lists(), which discards the entry.
    void append(std::uint32_t list, const CellEntry& entry) {
        Group& group = groups_[list >> group_bits_];
        if (group.end == group.chunk_end) [[unlikely]]
            add_chunk(group);
        StagedEntry& staged = stage_[group.end++];
        prefetch(&staged + 4);
        staged.list = list;
        std::memcpy(staged.entry, &entry, sizeof(CellEntry));
    }
    /// Does nothing: flush() empties the list that discards entries.
    void reset_discarded() {}
    /// True if flush() must be called before a further batch of `max_batch` entries.
    bool full() const { return free_ + needed_ > chunks_; }
    void flush();
    /// Makes the lists readable.
    void finish();

    static constexpr std::size_t max_batch = 8 * 256;  ///< 8 entries of each of 256 objects

private:
    struct StagedEntry {
        std::uint32_t list;
        std::uint32_t entry[4];  // CellEntry, without its alignment
    };
    /// A group of lists. Its entries are in chunks of the stage, linked by next_.
    struct Group {
        std::uint32_t end = 0, chunk_end = 0;  // positions in the stage: behind the last entry, behind its chunk
        std::uint32_t first = 0;               // first chunk
    };

    void add_chunk(Group& group);
    void flush(const Group& group);
    void append_all(const StagedEntry* begin, std::size_t count);

    ChunkWriter writer_;
    unsigned group_bits_ = 0;  // log2 of the number of lists of a group
    std::vector<Group> groups_;
    std::size_t chunk_size_, chunks_, needed_;
    std::size_t free_ = 0;  // first chunk that is in no group
    Buffer<StagedEntry> stage_;
    std::vector<std::uint32_t> next_;  // by chunk: next chunk of its group
};

}  // namespace octopair
