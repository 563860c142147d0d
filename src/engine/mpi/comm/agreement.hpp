// Agreement: all ranks go on with a call together, or all end it with the same Error.
//
// What fails on one rank alone (a box that is not one, a full disk, a stop) would let the others wait for it forever. So
// each part of a call that may fail runs in together(), at whose end the ranks tell each other how it went. Of several
// failures the one that the local engine would have met comes first: the object with the lowest index; a stop comes last.
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <stop_token>
#include <string>
#include <utility>

#include "engine/mpi/comm/communicator.hpp"
#include "octopair/error.hpp"

namespace octopair {

/// Bad input of which the others must know where it stands.
struct BadObject {
    std::uint64_t position;  ///< among the objects of all ranks, those of a second set after those of the first
    std::string message;
};

/// Makes the stop of any rank that of all, also while they work.
class StopRelay {
public:
    /// `stop`: of this rank's call. `beside`, which may be empty, is done whenever stops are looked for.
    StopRelay(Communicator& comm, std::stop_source& stop, std::function<void()> beside = {})
        : comm_(comm), stop_(stop), beside_(std::move(beside)) {
        comm_.set_meanwhile([this] { pass_on(); });
    }
    StopRelay(const StopRelay&) = delete;
    StopRelay& operator=(const StopRelay&) = delete;
    ~StopRelay() { comm_.set_meanwhile({}); }

    /// To be called every few milliseconds of work, on the thread of the call; the communicator does while it waits.
    void pass_on();
    /// Collective: afterwards nothing is under way.
    void end();

private:
    Communicator& comm_;
    std::stop_source& stop_;
    std::function<void()> beside_;
    bool sent_ = false;   // by this rank
    bool known_ = false;  // to all, or too late
};

class Agreement {
public:
    explicit Agreement(Communicator& comm) : comm_(comm) {}

    /// Runs `part`; throws on all ranks if it threw on any: Error, or what is not one on the rank that threw it.
    void together(const std::function<void()>& part);

private:
    struct Outcome;
    static Outcome outcome_of(const std::function<void()>& part);

    Communicator& comm_;
};

}  // namespace octopair
