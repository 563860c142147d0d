// RingReader: the client's side of a stream. Takes blocks of pairs from the rings and delivers them in the order of shares.
//
// Invariants
//   A slot runs its shares in ascending order and writes their blocks to its ring in order.
//   The next block of the stream is therefore at the front of the ring of the slot that has the next share.
//   A slot whose share is not the next one may fill its ring, and then waits.
//   A share that runs again writes the same pairs in the same order. So its first pairs can be skipped if they were delivered.
//   The slot with the next share always finds room, because all its earlier blocks have been taken: no deadlock.
#pragma once

#include <cstdint>
#include <optional>

#include "engine/passes.hpp"
#include "engine/processes/client/worker_pool.hpp"

namespace octopair {

struct RingSize {
    std::uint64_t blocks = 0;       ///< number of blocks in the ring of one slot
    std::uint64_t block_pairs = 0;  ///< capacity of one block, in pairs
};

/// Returns the ring size for which the rings of `slots` slots together hold at most `pairs` pairs. Each ring has at least
/// 2 blocks of 1 pair.
RingSize ring_size(std::uint64_t pairs, unsigned slots);

class RingReader {
public:
    RingReader(WorkerPool& pool, SharedMemory& pairs, const Pass& pass, const PairSink& deliver)
        : pool_(pool), pairs_(pairs), pass_(pass), deliver_(deliver) {}

    /// Delivers a limited number of the blocks that are ready. Returns true, and raises the client's event, if the limit was
    /// reached, so more blocks may be ready.
    /// Throws: what `deliver` throws; Error{engine_failed} if a ring is damaged.
    bool take();
    /// Drops the blocks of a slot's unfinished share, after its worker has ended. The replacement worker runs the share again.
    void forget_unfinished(unsigned slot);
    /// Returns true if all pairs of `shares` shares have been delivered.
    bool complete(std::uint64_t shares) const { return share_ == shares; }

private:
    bool take_next();
    std::optional<RingEntry> front(unsigned slot) const;
    void give_back(unsigned slot);
    bool take_block(unsigned slot);

    WorkerPool& pool_;
    SharedMemory& pairs_;
    const Pass& pass_;
    const PairSink& deliver_;
    std::uint64_t share_ = 0;      // the share to deliver next
    std::uint64_t delivered_ = 0;  // pairs of share_ that have been delivered
    std::uint64_t passed_ = 0;     // pairs of share_ in blocks taken since a worker last began the share
};

}  // namespace octopair
