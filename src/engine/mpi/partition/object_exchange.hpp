// ObjectExchange: sends the objects of one set to the ranks that own their octants.
//
//   plan      the ranks exchange the numbers of objects
//   pack      copies objects to arrays, ordered by receiving rank       (routing.hpp)
//   exchange  sends the arrays
//
// Positions  A message has 32 bits for each position, or only the lowest 16. 16 bits are enough if positions that follow each
//            other in the message are near, because they ascend (Routing::are_positions_near).
// Result     The received objects of all ranks, in rank order, ascend by position.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/memory.hpp"
#include "engine/mpi/comm/communicator.hpp"
#include "engine/mpi/joint_call.hpp"
#include "engine/mpi/partition/object_arrays.hpp"
#include "engine/mpi/partition/routing.hpp"
#include "octree/executor.hpp"

namespace octopair {

class ObjectExchange {
public:
    /// Arrays that are kept between calls, because the operating system must clear new pages first.
    struct Memory {
        ObjectArrays sent, received;
        Buffer<std::byte> positions;  ///< received positions, as sent
    };

    /// Collective. Exchanges the numbers of objects. Borrows all arguments.
    ObjectExchange(Communicator& comm, const JointCall& call, const Routing& routing, unsigned set);

    /// Returns the number of objects that this rank receives.
    std::uint64_t incoming() const { return counts_.incoming(); }
    /// Copies this rank's objects to the arrays of `memory`. Throws: std::bad_alloc.
    void pack(Executor& executor, const Objects& objects, Memory& memory) const;
    /// Collective. Sends the objects. Stores the received ones in `memory.received`. Requires: pack().
    void exchange(Memory& memory) const;

private:
    /// Data by which receivers decode the positions of a rank.
    struct Sender {
        std::uint64_t begin;           // position of its first object
        std::uint64_t position_bytes;  // 2 or 4
    };
    void decode_positions(Memory& memory) const;

    Communicator& comm_;
    const JointCall& call_;
    const Routing& routing_;
    unsigned set_;
    Exchange counts_;
    std::vector<Sender> senders_;  // for each sending rank
};

}  // namespace octopair
