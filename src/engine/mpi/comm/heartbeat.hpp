// Heartbeat: by it rank 0 tells ranks that work, however long it takes them, from those that are stopped, hang or are gone.
//
// While a rank works or waits for others it sends rank 0 a message without content, several times within the time that it may
// be silent. Nobody waits for these; what is done between two looks costs next to nothing.
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
    /// `silence`: that a rank may keep, the same on all.
    Heartbeat(Communicator& comm, std::chrono::milliseconds silence);

    /// All ranks are at it from here on.
    void begin();
    /// To be called every few milliseconds, on the thread of the call. On rank 0 it throws Error{engine_failed} once a rank was
    /// silent for too long, and from then on.
    void beat();
    /// What beat() has thrown.
    const std::optional<std::string>& lost() const { return lost_; }
    /// Collective, when no beat will follow: afterwards nothing is under way. Throws as beat().
    void end();

private:
    using Clock = std::chrono::steady_clock;

    void send(Clock::time_point now);
    void look(Clock::time_point now);
    void receive();

    Communicator& comm_;
    std::chrono::milliseconds silence_, apart_;
    Clock::time_point last_{};              // of sending, or looking
    std::vector<Clock::time_point> heard_;  // of each rank; on rank 0
    std::vector<std::uint64_t> received_;   // from each rank, in all
    std::uint64_t sent_ = 0;
    std::optional<std::string> lost_;
};

}  // namespace octopair
