#include "engine/turns.hpp"

#include <algorithm>
#include <utility>

#include "octopair/error.hpp"

namespace octopair {

Turns::Turn::Turn(Turns& turns, std::stop_token stop) : turns_(turns) {
    std::unique_lock lock(turns_.mutex_);
    auto& tickets = turns_.tickets_;
    const std::uint64_t ticket = turns_.next_ticket_++;
    tickets.push_back(ticket);
    const auto has_come = [&] { return tickets.front() == ticket; };
    if (has_come() || turns_.changed_.wait(lock, std::move(stop), has_come)) return;
    // Others wait for the first only, which this is not.
    tickets.erase(std::find(tickets.begin(), tickets.end(), ticket));
    throw Error(ErrorCode::cancelled, "cancelled");
}

Turns::Turn::~Turn() {
    const std::lock_guard lock(turns_.mutex_);
    turns_.tickets_.pop_front();
    if (!turns_.tickets_.empty()) turns_.changed_.notify_all();
}

}  // namespace octopair
