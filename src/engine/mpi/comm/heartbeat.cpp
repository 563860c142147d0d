#include "engine/mpi/comm/heartbeat.hpp"

#include <algorithm>

#include "octopair/error.hpp"

namespace octopair {

namespace {

constexpr std::chrono::milliseconds max_interval(1000);

/// Returns a time in seconds as text, such as "1.500 s".
std::string seconds_text(std::chrono::milliseconds time) {
    std::string text = std::to_string(time.count() / 1000);
    if (const auto rest = time.count() % 1000; rest > 0) text += "." + std::to_string(1000 + rest).substr(1);
    return text + " s";
}

}  // namespace

Heartbeat::Heartbeat(Communicator& comm, std::chrono::milliseconds silence)
    : comm_(comm),
      silence_(silence),
      interval_(std::min(max_interval, silence / 8)),
      last_heard_(comm.size()),
      received_(comm.size(), 0) {}

void Heartbeat::begin() {
    last_ = Clock::now();
    std::ranges::fill(last_heard_, last_);
}

void Heartbeat::beat() {
    if (lost_) throw Error(ErrorCode::engine_failed, *lost_);
    const auto now = Clock::now();
    if (now - last_ < interval_) return;
    comm_.rank() == 0 ? check_silence(now) : send(now);
}

void Heartbeat::send(Clock::time_point now) {
    if (comm_.send_heartbeat()) ++sent_;
    last_ = now;
}

void Heartbeat::receive() {
    while (const auto rank = comm_.receive_heartbeat()) {
        ++received_[*rank];
        last_heard_[*rank] = last_;
    }
}

/// Silence counts only while rank 0 itself checks regularly: rank 0 may have been stopped together with all other ranks.
void Heartbeat::check_silence(Clock::time_point now) {
    const bool listened = now - last_ < silence_ / 2;
    last_ = now;
    if (!listened) std::ranges::fill(last_heard_, now);
    receive();
    const auto longest = std::min_element(last_heard_.begin() + 1, last_heard_.end());
    if (longest == last_heard_.end() || now - *longest < silence_) return;
    lost_ = "rank " + std::to_string(longest - last_heard_.begin()) + " has not answered for " + seconds_text(silence_);
    throw Error(ErrorCode::engine_failed, *lost_);
}

void Heartbeat::end() {
    const std::vector<std::uint64_t> sent = comm_.all_gather(sent_);
    if (comm_.rank() != 0) return;
    // MPI cannot wake this thread when a heartbeat arrives, so the thread probes for heartbeats and pauses between the probes.
    const Backoff backoff;
    for (receive(); received_ != sent; receive()) backoff();
}

}  // namespace octopair
