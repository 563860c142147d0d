// Agreement: either all ranks continue a call, or all ranks end it with the same Error.
//
// Purpose    a failure of one rank alone (an invalid box, a full disk, a stop request) would make the other ranks wait forever.
//            So each part of a call that may fail runs in together(). At its end the ranks exchange their outcomes.
// Priority   if several ranks fail, all report the failure that the local engine would meet first: the invalid object with the
//            lowest position, then errors, then exceptions that are no Error, each of the lowest rank; a stop comes last.
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>

#include "engine/mpi/comm/communicator.hpp"
#include "octopair/error.hpp"

namespace octopair {

/// Exception for an invalid object, with the position by which the ranks select the first invalid object.
struct BadObject {
    std::uint64_t position;  ///< among the objects of all ranks, the second set after the first
    std::string message;
    std::optional<ErrorPlace> place = {};  ///< the object as the message names it; has no frame
};

/// Forwards a stop request of one rank to all ranks, while the ranks work or wait.
class StopRelay {
public:
    /// `stop`: stop source of this rank's call; borrowed. `on_poll` may be empty; each poll() runs it first.
    StopRelay(Communicator& comm, std::stop_source& stop, std::function<void()> on_poll = {})
        : comm_(comm), stop_(stop), on_poll_(std::move(on_poll)) {
        comm_.set_wait_hook([this] { poll(); });
    }
    StopRelay(const StopRelay&) = delete;
    StopRelay& operator=(const StopRelay&) = delete;
    ~StopRelay() { comm_.set_wait_hook({}); }

    /// Sends this rank's stop request, or receives that of another rank. Call every few milliseconds of work, on the thread of
    /// the call. The communicator calls poll() while it waits.
    void poll();
    /// Collective. Afterwards no stop message is in flight.
    void end();

private:
    Communicator& comm_;
    std::stop_source& stop_;
    std::function<void()> on_poll_;
    bool sent_ = false;   // this rank has sent its stop request
    bool known_ = false;  // true: all ranks have a stop request, or the call ends. Sends and receives no stop any more
};

class Agreement {
public:
    explicit Agreement(Communicator& comm) : comm_(comm) {}

    /// Collective. Runs `part`, and throws on all ranks if `part` threw on any rank.
    /// Throws: the same Error on all ranks; but a rank whose `part` threw an exception of another type rethrows that one.
    void together(const std::function<void()>& part);

private:
    struct Outcome;
    static Outcome outcome_of(const std::function<void()>& part);

    Communicator& comm_;
};

}  // namespace octopair
