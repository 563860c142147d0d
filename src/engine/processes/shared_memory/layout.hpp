// Layout of the memory that the client and its workers share.
//
//   control block    one file: ControlBlock, a Slot for each worker, then the tables below; client and workers write it
//             shares   a Share for each share of the work of a pass, in order: its status and its result
//             runs     the runs of pairs that finished shares found
//             commits  two for each slot, written alternately: how far its buckets are filled (ascending order)
//             rings    for each slot: filled blocks of pairs that the client has not taken yet (streams)
//             logs     for each slot: the pages that its buckets (bucket_sort.hpp) have taken (ascending order)
//   arena   data that one step writes and later steps read, at the same offsets in all processes (Arena)
//   pairs   blocks of pairs
//   inputs  boxes and paddings: copies by the client, or arrays that the application allocated with the engine
//
// A pass is one request of the client to all its workers. All of them run the same program.
//
// Invariants
//   Each step has the same shares, in the same order, in all workers of a pass. A share's number therefore identifies it.
//   A share belongs to the slot that claims it. If its worker dies, the replacement worker in that slot runs it again.
//   A share reads only complete data, and writes data that no process reads before the share is done, except blocks of a stream.
//   Every number in this memory is checked before use: a worker that died may have left any value.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "engine/bucket_sort.hpp"
#include "engine/processes/shared_memory/event_count.hpp"
#include "octopair/limits.hpp"
#include "octopair/objects.hpp"

namespace octopair {

inline constexpr std::uint64_t control_mark = 0x6f63746f70616972;  // "octopair"
inline constexpr std::uint32_t layout_version = 7;                 // raised with every change of the layout

/// Step of the algorithm that a share belongs to. `encode` is encode and scatter; `order` sorts pairs into ascending order.
enum class Step : std::uint32_t { prepare, encode, count, scan, order };
inline constexpr std::array<const char*, 5> step_names = {"prepare", "encode", "count", "scan", "order"};

enum class PassKind : std::uint32_t { count, count_by_object, list_octal, stream_octal, list_ascending };

/// An array in a region: `count` elements from byte `offset` on. If `count` is 0, the array is empty and the region is not used.
struct ArrayRef {
    std::uint32_t region = 0;
    std::uint64_t offset = 0;
    std::uint64_t count = 0;
};

struct SetRef {
    ArrayRef boxes;
    ArrayRef padding;
    std::uint32_t wide = 0;  ///< 1: boxes are Box3d; 0: Box3f
};

struct Pass {
    std::uint32_t job = 0;  ///< job number; passes of one job use the same objects
    PassKind kind = PassKind::count;
    std::uint32_t workers = 0;  ///< number of workers that run the pass
    std::uint32_t built = 0;    ///< 1: an earlier pass of this job has built the octree
    SetRef first, second;
    std::uint32_t join = 0;
    double margin = 0;
    std::uint32_t arena_region = 0, pairs_region = 0;
    AscendingBounds bounds;
    std::uint64_t block_pairs = 0;  ///< capacity of one block of a stream, in pairs
    std::uint64_t ring_blocks = 0;  ///< number of blocks in the ring of one slot
};

/// How a worker's part of a pass ended.
enum class Outcome : std::uint32_t { none, done, failed, stopped, bad_box, over_budget };

struct alignas(64) Slot {
    EventCount command;                    ///< raised when `requested` changes or the ring has room again
    std::atomic<std::uint32_t> requested;  ///< number of the pass that the worker must run
    std::atomic<std::uint32_t> finished;   ///< number of the last finished pass, whose outcome is below
    std::atomic<std::uint32_t> attached;   ///< 1: the worker has mapped the control block and serves this slot
    std::atomic<std::uint32_t> preparing;  ///< 1: the worker has begun a pass, but has not reached its first share
    std::atomic<std::uint32_t> waits;      ///< 1: the worker waits for the client or another worker
    std::atomic<std::uint64_t> share;      ///< 1 + number of the current share; 0: none
    std::atomic<std::uint64_t> entries_scanned;
    std::atomic<std::uint64_t> pairs_to_order;  ///< pairs of all slots, as soon as their sorting begins; before, 0
    std::atomic<std::uint64_t> pairs_ordered;   ///< pairs that this slot has sorted (ascending)
    std::atomic<std::uint64_t> pages_taken;
    std::atomic<std::uint64_t> ring_filled, ring_taken;  ///< ring entries written and taken since the pass began
    Outcome outcome;
    std::uint32_t error_code;
    std::array<char, 256> message;
    std::uint64_t number;  ///< bad_box: first position to check; count_by_object: arena offset of the counts
    std::uint64_t entries, shares;
    double encode_seconds, count_seconds, scatter_seconds, scan_seconds;
};

struct ControlBlock {
    std::uint64_t mark;
    std::uint32_t layout;
    std::array<char, 32> version;
    std::int32_t client;  ///< process id of the client
    std::atomic<std::uint32_t> slots;
    EventCount among_workers;            ///< raised when a worker finds no further share in a step
    EventCount for_client;               ///< raised when a worker finishes or writes a block of pairs
    std::atomic<std::uint32_t> stopped;  ///< number of the pass that must stop
    std::atomic<std::uint64_t> next_block, next_run;
    std::atomic<std::int64_t> pages_left;
    Pass pass;
};

/// Record of one share of a pass. The pass number in `state` distinguishes it from records of earlier passes.
struct Share {
    std::atomic<std::uint64_t> state;
    std::uint64_t pairs;      ///< number of pairs found (list, count)
    std::uint64_t first_run;  ///< index of the first run of these pairs
    std::uint32_t runs;
    std::atomic<std::uint32_t> step;
    std::uint64_t commit;  ///< number of the slot's commit that includes this share (ascending)
};

enum class ShareStatus : std::uint32_t { free, claimed, done };

/// Unpacked form of Share::state.
struct ShareState {
    std::uint32_t pass = 0;
    ShareStatus status = ShareStatus::free;
    std::uint32_t slot = 0;

    static ShareState of(std::uint64_t packed) {
        return {std::uint32_t(packed >> 32), ShareStatus(packed >> 16 & 3), std::uint32_t(packed & 0xFFFF)};
    }
    std::uint64_t packed() const {
        return std::uint64_t(pass) << 32 | std::uint64_t(status) << 16 | std::uint64_t(slot);
    }
    bool is(std::uint32_t in_pass, ShareStatus with) const { return pass == in_pass && status == with; }
};

/// A contiguous run of pairs in the region `pairs`: first index and number of pairs.
struct Run {
    std::uint64_t begin, count;
};

/// Committed content of a slot's buckets. Pages and pairs beyond `log_size` and `sizes` belong to an unfinished share.
struct Commit {
    std::uint64_t log_size, pages_taken;
    std::array<std::uint64_t, std::size_t(1) << BucketPlan::max_bits> sizes;
};

/// A page of a bucket: page number in the region `pairs`, and bucket number.
struct LoggedPage {
    std::uint32_t page, bucket;
};

/// A filled block of a stream. Block i of the ring is the i-th block in the slot's part of the region `pairs`.
struct RingEntry {
    std::uint64_t share, pairs;
    std::uint64_t last;  ///< 1: last block of the share
};

inline constexpr std::uint64_t max_shares = std::uint64_t(1) << 24;
inline constexpr std::uint64_t max_runs = std::uint64_t(1) << 26;
inline constexpr std::uint64_t max_logged = std::uint64_t(1) << 26;  // pages of one slot; at 512 pairs a page, 256 GiB
inline constexpr std::uint64_t max_ring_blocks = 64;
inline constexpr std::uint64_t list_block_pairs = 1 << 15;
static_assert(list_block_pairs % default_tuning.output.page == 0);  // pages are numbered from the begin of the region

constexpr std::uint64_t whole_pages(std::uint64_t bytes) {
    constexpr std::uint64_t page = 4096;
    return (bytes + page - 1) / page * page;
}

/// Byte offsets of the tables in the control block's file.
struct ControlBlockLayout {
    static constexpr std::uint64_t slots = whole_pages(sizeof(ControlBlock));
    static constexpr std::uint64_t shares = slots + whole_pages(max_workers * sizeof(Slot));
    static constexpr std::uint64_t runs = shares + whole_pages(max_shares * sizeof(Share));
    static constexpr std::uint64_t commits = runs + whole_pages(max_runs * sizeof(Run));
    static constexpr std::uint64_t rings = commits + whole_pages(max_workers * 2 * sizeof(Commit));
    static constexpr std::uint64_t logs = rings + whole_pages(max_workers * max_ring_blocks * sizeof(RingEntry));
    /// Returns the size of the file. The logs of all `workers` slots are its last part.
    static constexpr std::uint64_t bytes(unsigned workers) {
        return logs + std::uint64_t(workers) * max_logged * sizeof(LoggedPage);
    }
};

}  // namespace octopair
