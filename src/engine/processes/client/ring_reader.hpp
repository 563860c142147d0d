// RingReader: the client's side of a stream. It hands out the pairs of shares in the order of the shares.
//
// A slot does its shares in order and hands over their blocks in order, so the block that is next of all is next in the
// ring of the slot that has that share. While that slot's share is not next, its ring may fill up and it waits; the one
// whose share is next always finds room, because all that it handed over before has been taken.
#pragma once

#include <cstdint>
#include <optional>

#include "engine/processes/client/worker_pool.hpp"
#include "engine/search.hpp"

namespace octopair {

struct RingSize {
    std::uint64_t blocks = 0;       ///< of a slot
    std::uint64_t block_pairs = 0;  ///< of a block
};

/// So that all slots together hold at most `pairs`.
RingSize ring_size(std::uint64_t pairs, unsigned slots);

class RingReader {
public:
    RingReader(WorkerPool& pool, SharedMemory& pairs, const Pass& pass, const Deliver& deliver)
        : pool_(pool), pairs_(pairs), pass_(pass), deliver_(deliver) {}

    /// Hands out some of what is there; true, and the client's event is raised, if that is not all. What `deliver` throws
    /// is passed on.
    bool take();
    /// The worker of a slot is gone, and another will do its share again: what it left of it is dropped.
    void forget_unfinished(unsigned slot);
    /// Whether it has handed out all of so many shares.
    bool complete(std::uint64_t shares) const { return share_ == shares; }

private:
    bool take_next();
    std::optional<RingEntry> front(unsigned slot) const;
    void give_back(unsigned slot);
    bool take_block(unsigned slot);

    WorkerPool& pool_;
    SharedMemory& pairs_;
    const Pass& pass_;
    const Deliver& deliver_;
    std::uint64_t share_ = 0;      // the next one
    std::uint64_t delivered_ = 0;  // pairs of it
    std::uint64_t passed_ = 0;     // pairs of it in blocks taken since it was begun last
};

}  // namespace octopair
