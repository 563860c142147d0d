// Timeouts of the client and its workers, and the numbers of failures that the client accepts.
// Start here to change the timeouts of workers.
//
// A worker that is stopped by a signal is killed at the next check. A worker that computes for long is never killed: no time
// limits a share.
#pragma once

#include <chrono>

namespace octopair {

namespace worker_timeouts {

using std::chrono::milliseconds;

// The client.
inline constexpr milliseconds check_interval(20);         ///< interval between checks of the workers' state
inline constexpr milliseconds pass_exit_timeout(2000);    ///< after a pass failed: a worker still in the pass is killed
inline constexpr milliseconds attach_timeout(5000);       ///< after its start: a worker that has not attached is killed
inline constexpr milliseconds deadlock_timeout(5000);     ///< all workers wait without any event: the pass fails
inline constexpr milliseconds healthy_lifetime(60'000);   ///< a worker that lived longer does not count as a crash loop
inline constexpr unsigned max_spins_for_pass_end = 4000;  ///< polls of the client before it sleeps, about 80 us

// A worker.
inline constexpr milliseconds client_check_interval(1000);  ///< interval between checks that the client is alive
inline constexpr milliseconds max_event_sleep(100);  ///< in a pass: longest sleep before a worker checks for a stop
inline constexpr milliseconds max_command_sleep(3'600'000);  ///< between passes: longest sleep of a worker
inline constexpr unsigned max_spins_for_event = 2000;        ///< about 40 us: workers often finish a step together
inline constexpr unsigned max_spins_for_pass = 4000;         ///< about 80 us: calls often follow each other closely

}  // namespace worker_timeouts

/// Numbers of failures, after which the client gives up.
namespace worker_failures {

inline constexpr unsigned max_failed_starts = 3;           ///< consecutive, in one slot
inline constexpr unsigned max_deaths_per_share = 3;        ///< as many deaths of workers in one share fail the pass
inline constexpr unsigned max_deaths_between_shares = 10;  ///< consecutive, in one slot

}  // namespace worker_failures

}  // namespace octopair
