// Heartbeat: rank 0 detects ranks that are stopped, hang or have died. A rank that works is alive, however long its work takes.
//
// While a rank works or waits for others, it sends messages without content to rank 0: several within the longest permitted
// silence. No rank waits for these messages. A call of beat() before the next message is due only reads the clock.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/mpi/comm/communicator.hpp"

namespace octopair {

class Heartbeat {
public:
    /// `silence`: longest time that a rank may be silent; the same on all ranks.
    Heartbeat(Communicator& comm, std::chrono::milliseconds silence);

    /// Starts a period in which all ranks call beat(). Resets the measured silence of all ranks.
    void begin();
    /// Sends a heartbeat, or checks those of the other ranks on rank 0, if one is due. Call every few milliseconds, on the
    /// thread of the call. Throws: on rank 0, Error{engine_failed} once a rank was silent for too long, and in each later call.
    void beat();
    /// Returns the message of the Error that beat() threw; none before.
    const std::optional<std::string>& lost() const { return lost_; }
    /// Collective. Call when no beat() will follow. Afterwards no heartbeat is in flight.
    void end();

private:
    using Clock = std::chrono::steady_clock;

    void send(Clock::time_point now);
    void check_silence(Clock::time_point now);
    void receive();

    Communicator& comm_;
    std::chrono::milliseconds silence_, interval_;
    Clock::time_point last_{};                   // time of the last heartbeat sent, or of the last check on rank 0
    std::vector<Clock::time_point> last_heard_;  // time of the last heartbeat of each rank; on rank 0
    std::vector<std::uint64_t> received_;        // number of heartbeats received from each rank; on rank 0
    std::uint64_t sent_ = 0;                     // number of heartbeats sent
    std::optional<std::string> lost_;
};

}  // namespace octopair
