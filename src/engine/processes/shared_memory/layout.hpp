// What lies where in the memory that the client and its workers share.
//
//   control block    one file: ControlBlock, a Slot for each worker, then the tables below. Written by all.
//             shares   what is done and what is not: a Share for each share of the work of a pass, in order
//             runs     of the pairs of shares that are done, one after another
//             commits  two of each slot, used in turn: how far its buckets are filled (ascending order)
//             logs     of each slot: the pages of its buckets
//             ring     of each slot: filled blocks of pairs that the client has not taken (streams)
//   arena   what the steps leave for each other, at the same places for all (arena.hpp)
//   pairs   blocks of pairs
//   inputs  boxes and paddings; the client's copies, or arrays that the application had the engine allocate
//
// A pass is what the client asks of all workers at once. All of them run the same program, in which each step's shares
// come in the same order, so that a share's number says what it is. A share belongs to the slot that claims it. If its
// worker dies, the one that takes over the slot finds it claimed and does it again: shares read what is complete and
// write what nobody reads before they are done.
//
// Whatever a number here says is checked before it is used: what died may have left anything.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "engine/ascending_bounds.hpp"
#include "engine/bucket_sort.hpp"
#include "engine/processes/shared_memory/futex.hpp"
#include "octopair/objects.hpp"

namespace octopair {

inline constexpr unsigned most_workers = 256;
inline constexpr std::uint64_t control_mark = 0x6f63746f70616972;  // "octopair"
inline constexpr std::uint32_t layout_version = 4;              // of this file: raised with every change of it

/// Which step of the algorithm a share belongs to. `order` puts pairs into ascending order.
enum class Step : std::uint32_t { prepare, encode, count, scatter, scan, order };
inline constexpr std::array<const char*, 6> step_names = {"prepare", "encode", "count", "scatter", "scan", "order"};

enum class PassKind : std::uint32_t { lists, count, count_by_object, list_octal, stream_octal, list_ascending };

/// An array in a region: `count` elements from byte `offset` on. None where count is 0.
struct ArrayRef {
    std::uint32_t region = 0;
    std::uint64_t offset = 0;
    std::uint64_t count = 0;
};

struct SetRef {
    ArrayRef boxes;
    ArrayRef padding;
    std::uint32_t wide = 0;  ///< boxes are Box3d
};

struct Pass {
    std::uint32_t job = 0;  ///< passes of one job are about the same objects
    PassKind kind = PassKind::count;
    std::uint32_t workers = 0;  ///< how many take part
    std::uint32_t built = 0;    ///< the octree is there, made by an earlier pass of this job
    SetRef first, second;
    std::uint32_t join = 0;
    double margin = 0;
    std::uint32_t arena_region = 0, pairs_region = 0;
    AscendingBounds bounds;
    std::uint64_t block_pairs = 0;  ///< of a block of a stream
    std::uint64_t ring_blocks = 0;  ///< of a slot
};

/// How a worker's part of a pass ended.
enum class Outcome : std::uint32_t { none, done, failed, stopped, bad_box, over_budget };

struct alignas(64) Slot {
    Event command;                         ///< raised when `asked` has changed, or there is room in the ring
    std::atomic<std::uint32_t> asked;      ///< the pass to do, by its number
    std::atomic<std::uint32_t> finished;   ///< the pass whose outcome is below
    std::atomic<std::uint32_t> attached;   ///< whether the worker has found its way to here
    std::atomic<std::uint32_t> preparing;  ///< whether it is in a pass and has not come to a share
    std::atomic<std::uint32_t> waits;      ///< whether it can do nothing before the client or another worker has
    std::atomic<std::uint64_t> share;      ///< 1 + the number of the share under way; 0 if there is none
    std::atomic<std::uint64_t> entries_scanned;
    std::atomic<std::uint64_t> pages_taken;
    std::atomic<std::uint64_t> ring_filled, ring_taken;  ///< entries ever
    Outcome outcome;
    std::uint32_t error_code;
    std::array<char, 256> message;
    std::uint64_t number;  ///< bad_box: where to look; count_by_object: where in the arena the counts are
    std::uint64_t entries, shares;
    double encode_seconds, count_seconds, scatter_seconds, scan_seconds;
};

struct ControlBlock {
    std::uint64_t mark;
    std::uint32_t layout;
    std::array<char, 32> version;
    std::int32_t client;  ///< its process
    std::atomic<std::uint32_t> slots;
    Event among_workers;                 ///< a worker has no more to do in a step
    Event for_client;                    ///< a worker has finished, or there are pairs to take
    std::atomic<std::uint32_t> stopped;  ///< the pass that is not wanted any more
    std::atomic<std::uint64_t> next_block, next_run;
    std::atomic<std::int64_t> pages_left;
    Pass pass;
};

/// Of one share of a pass. What is left from earlier passes shows by the pass's number in `state`.
struct Share {
    std::atomic<std::uint64_t> state;
    std::uint64_t pairs;      ///< how many were found (list, count)
    std::uint64_t first_run;  ///< of these pairs
    std::uint32_t runs;
    std::uint32_t step;
    std::uint64_t commit;  ///< of its slot, with this share in it (ascending)
};

enum class ShareStatus : std::uint32_t { free, claimed, done };

/// Share::state in words.
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

/// Pairs that lie together in the region `pairs`.
struct Run {
    std::uint64_t begin, count;
};

/// What a slot's buckets hold. Beyond `log_size` and `sizes` there may be more, of a share that was not done.
struct Commit {
    std::uint64_t log_size, pages_taken;
    std::array<std::uint64_t, std::size_t(1) << BucketPlan::most_bits> sizes;
};

/// A page of a bucket, by its number in the region `pairs`.
struct LoggedPage {
    std::uint32_t page, bucket;
};

/// A filled block of a stream; block i of the ring is the i-th of the slot's part of the region `pairs`.
struct RingEntry {
    std::uint64_t share, pairs;
    std::uint64_t last;  ///< whether the share has no more
};

inline constexpr std::uint64_t most_shares = std::uint64_t(1) << 24;
inline constexpr std::uint64_t most_runs = std::uint64_t(1) << 26;
inline constexpr std::uint64_t most_logged = std::uint64_t(1) << 26;  // pages of one slot: 256 GiB
inline constexpr std::uint64_t most_ring_blocks = 64;
inline constexpr std::uint64_t list_block_pairs = 1 << 15;

constexpr std::uint64_t whole_pages(std::uint64_t bytes) {
    constexpr std::uint64_t page = 4096;
    return (bytes + page - 1) / page * page;
}

/// Where in the control block's file the tables are.
struct ControlBlockLayout {
    static constexpr std::uint64_t slots = whole_pages(sizeof(ControlBlock));
    static constexpr std::uint64_t shares = slots + whole_pages(most_workers * sizeof(Slot));
    static constexpr std::uint64_t runs = shares + whole_pages(most_shares * sizeof(Share));
    static constexpr std::uint64_t commits = runs + whole_pages(most_runs * sizeof(Run));
    static constexpr std::uint64_t rings = commits + whole_pages(most_workers * 2 * sizeof(Commit));
    static constexpr std::uint64_t logs = rings + whole_pages(most_workers * most_ring_blocks * sizeof(RingEntry));
    /// The logs of so many slots end it.
    static constexpr std::uint64_t bytes(unsigned workers) {
        return logs + std::uint64_t(workers) * most_logged * sizeof(LoggedPage);
    }
};

}  // namespace octopair
