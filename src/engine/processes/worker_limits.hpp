// How long the client and its workers wait for each other, and how often workers may fail.
#pragma once

#include <chrono>

namespace octopair::worker_limits {

using std::chrono::milliseconds;

// The client.
inline constexpr milliseconds check_interval(20);          ///< between two checks of the workers' state
inline constexpr milliseconds pass_exit_timeout(2000);     ///< a worker still in a failed pass by then is killed
inline constexpr milliseconds attach_timeout(5000);        ///< a worker that has not attached by then is killed
inline constexpr milliseconds deadlock_timeout(5000);      ///< all workers wait and no event comes: the pass fails
inline constexpr milliseconds healthy_lifetime(60'000);    ///< a worker that lived as long is not part of a crash loop
inline constexpr unsigned max_failed_starts = 3;           ///< of one worker, in a row
inline constexpr unsigned max_deaths_per_share = 3;        ///< workers that die in the same share of work
inline constexpr unsigned max_deaths_between_shares = 10;  ///< of one worker, in a row
inline constexpr unsigned max_spins_for_pass_end = 4000;   ///< about 80 us, before the client sleeps

// A worker.
inline constexpr milliseconds client_check_interval(1000);   ///< between two checks that the client lives
inline constexpr milliseconds max_event_sleep(100);          ///< in a pass, before a worker checks for a stop
inline constexpr milliseconds max_command_sleep(3'600'000);  ///< between two passes, before a worker checks again
inline constexpr unsigned max_spins_for_event = 2000;  ///< about 40 us: the other workers tend to end at the same time
inline constexpr unsigned max_spins_for_pass = 4000;   ///< about 80 us: calls tend to follow one another

}  // namespace octopair::worker_limits
