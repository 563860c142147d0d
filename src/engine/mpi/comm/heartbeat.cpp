#include "engine/mpi/comm/heartbeat.hpp"

#include <algorithm>

#include "octopair/error.hpp"

namespace octopair {

namespace {

constexpr std::chrono::milliseconds most_apart(1000);

/// As a number of seconds is read.
std::string seconds_text(std::chrono::milliseconds time) {
    std::string text = std::to_string(time.count() / 1000);
    if (const auto rest = time.count() % 1000; rest > 0) text += "." + std::to_string(1000 + rest).substr(1);
    return text + " s";
}

}  // namespace

Heartbeat::Heartbeat(Communicator& comm, std::chrono::milliseconds silence)
    : comm_(comm),
      silence_(silence),
      apart_(std::min(most_apart, silence / 8)),
      heard_(comm.size()),
      received_(comm.size(), 0) {}

void Heartbeat::begin() {
    last_ = Clock::now();
    std::ranges::fill(heard_, last_);
}

void Heartbeat::beat() {
    if (lost_) throw Error(ErrorCode::engine_failed, *lost_);
    const auto now = Clock::now();
    if (now - last_ < apart_) return;
    comm_.rank() == 0 ? look(now) : send(now);
}

void Heartbeat::send(Clock::time_point now) {
    if (comm_.send_heartbeat()) ++sent_;
    last_ = now;
}

void Heartbeat::receive() {
    while (const auto rank = comm_.receive_heartbeat()) {
        ++received_[*rank];
        heard_[*rank] = last_;
    }
}

/// Silence counts while rank 0 listens: it may have been stopped itself, together with all others.
void Heartbeat::look(Clock::time_point now) {
    const bool listened = now - last_ < silence_ / 2;
    last_ = now;
    if (!listened) std::ranges::fill(heard_, now);
    receive();
    const auto longest = std::min_element(heard_.begin() + 1, heard_.end());
    if (longest == heard_.end() || now - *longest < silence_) return;
    lost_ = "rank " + std::to_string(longest - heard_.begin()) + " has not answered for " + seconds_text(silence_);
    throw Error(ErrorCode::engine_failed, *lost_);
}

void Heartbeat::end() {
    const std::vector<std::uint64_t> sent = comm_.all_gather(sent_);
    if (comm_.rank() != 0) return;
    while (received_ != sent) receive();
}

}  // namespace octopair
