// Relay: pairs of any rank on their way to the receiver that rank 0 has, some at a time.
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

    /// `take`: of rank 0; borrowed.
    Relay(Communicator& comm, const PairSink& take) : comm_(comm), agreement_(comm), take_(take) {}

    /// Collective: rank `from` calls give(sink), and what that gives the sink is taken on rank 0, in that order. The sink is for
    /// the thread of the call. What `give` or `take` throws is thrown as by Agreement::together.
    void hand_on(unsigned from, const Give& give);

private:
    void send(unsigned from, const Give& give);
    void pass(unsigned from);
    void receive(unsigned from);

    Communicator& comm_;
    Agreement agreement_;
    const PairSink& take_;
    std::vector<Pair> held_;  // on the rank that sends
    Buffer<Pair> received_;   // on rank 0
};

}  // namespace octopair
