// ChunkLists: one list of entries for each octant and block of objects, in chunks of memory.
//
// One pass over the objects appends entries to the lists, without knowing their lengths. A reader visits the lists of an octant
// in the order of blocks, so it sees the same entries for any number of blocks.
//
// ChunkWriter appends the entries of one block. StagedWriter does the same for very many lists, in two passes.
//
// Invariants
//   A chunk has room for `chunk_size` entries, a power of two, and belongs to one list. next_ links the chunks of a list, in
//   ascending order.
//   Each block has its own range of the memory, of which it commits as much as it needs.
//   Chunk 0 of a block belongs to no list: list number `lists` discards entries there. So position 0 means an empty list.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "base/memory.hpp"
#include "base/private_export.hpp"
#include "boxes/entry.hpp"

namespace octopair {

/// Objects [begin, end).
struct ObjectBlock {
    std::size_t begin = 0, end = 0;
};

class OCTOPAIR_PRIVATE_EXPORT ChunkLists {
public:
    explicit ChunkLists(PageSource& pages) : entries_(pages), next_(pages), ends_(pages) {}

    /// Makes room for `blocks` blocks with `lists` lists each. No block has more than `max_entries_per_block` entries.
    void resize(std::size_t blocks, std::size_t lists, std::size_t max_entries_per_block);

    std::size_t lists() const { return lists_; }

    /// Calls visit(entries) for each run of adjacent entries of a list, in the order of blocks.
    /// Throws: Error{engine_failed} if the chunks are not in order: a process that shares the memory has damaged them.
    template <typename Visit>
    void for_each_run(std::size_t list, Visit&& visit) const {
        for (std::size_t block = 0; block < blocks_; ++block) for_each_run(block, list, visit);
    }
    template <typename Visit>
    void for_each_run(std::size_t block, std::size_t list, Visit&& visit) const {
        const Ends ends = ends_[block * lists_ + list];
        if (ends.end == 0) return;
        const CellEntry* const entries = entries_.data() + block * entries_per_block_;
        const std::uint32_t* const next = next_.data() + block * chunks_per_block_;
        const std::size_t last = (ends.end - 1) / chunk_size_;
        for (std::size_t chunk = ends.first; chunk != last;) {
            visit(std::span(entries + chunk * chunk_size_, chunk_size_));
            const std::size_t following = next[chunk];
            if (following <= chunk || following > last) [[unlikely]]
                throw_damaged();
            chunk = following;
        }
        visit(std::span(entries + last * chunk_size_, ends.end - last * chunk_size_));
    }

    static constexpr std::size_t min_chunk = 16;

private:
    friend class ChunkWriter;
    /// First chunk of a list, and position behind its last entry; 0 if the list is empty.
    struct Ends {
        std::uint32_t first, end;
    };

    [[noreturn]] static void throw_damaged();

    Buffer<CellEntry> entries_;
    Buffer<std::uint32_t> next_;  // by chunk: next chunk of its list
    Buffer<Ends> ends_;           // by block and list
    std::size_t blocks_ = 0, lists_ = 0, chunk_size_ = min_chunk;
    std::size_t entries_per_block_ = 0, chunks_per_block_ = 0;
};

/// Appends the entries of one block of objects.
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
    /// Empties the list that discards entries. Between two calls, at most ChunkLists::min_chunk - 1 entries may be discarded.
    void reset_discarded() { heads_[of_.lists_] = 1; }
    /// Always false: unlike a StagedWriter, this writer has no stage that can be full.
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
    std::vector<std::uint32_t> heads_, firsts_;  // by list: position after its last entry; its first chunk
    std::uint32_t chunks_ = 1;
    std::size_t committed_ = 0;  // chunks
};

/// Appends the entries of one block of objects to very many lists.
///
/// A ChunkWriter writes each entry to the end of its list. If there are more lists than the caches and the TLB hold the ends of,
/// almost each write waits for memory. A StagedWriter distributes entries in two passes, as an MSD radix sort does: first to
/// groups of adjacent lists, then group by group to the lists. Each pass writes to a few hundred places. The entries of a list stay in
/// the order in which they are appended. The stage has a fixed size. When it is nearly full, all its entries go to their lists.
///
/// Source: Manegold, Boncz, Kersten 2002, "Optimizing main-memory join on modern hardware" (radix cluster in several passes).
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
