// Relay: sends the pairs of any rank to the sink of rank 0, in batches.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "base/memory.hpp"
#include "engine/mpi/comm/agreement.hpp"
#include "engine/mpi/comm/communicator.hpp"
#include "octopair/engine.hpp"

namespace octopair {

class Relay {
public:
    using Give = std::function<void(const PairSink&)>;

    /// `take`: the sink of rank 0, not used on other ranks; borrowed.
    Relay(Communicator& comm, const PairSink& take) : comm_(comm), agreement_(comm), take_(take) {}

    /// Collective. Rank `from` calls give(sink). The pairs that `give` passes to `sink` reach the sink of rank 0, in the same
    /// order. `give` must call `sink` on the thread of the call. Throws: as Agreement::together for exceptions of `give`
    /// and of the sink of rank 0.
    void forward(unsigned from, const Give& give);

private:
    void send(unsigned from, const Give& give);
    void send_held(unsigned from);
    void receive(unsigned from);

    Communicator& comm_;
    Agreement agreement_;
    const PairSink& take_;
    std::vector<Pair> held_;  // next batch, on the rank that sends
    Buffer<Pair> received_;   // last batch, on rank 0
};

}  // namespace octopair
