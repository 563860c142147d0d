#include "engine/ticket_lock.hpp"

#include <algorithm>
#include <utility>

#include "octopair/error.hpp"

namespace octopair {

TicketLock::Guard::Guard(TicketLock& lock, std::stop_token stop) : lock_(lock) {
    std::unique_lock mutex_lock(lock_.mutex_);
    auto& tickets = lock_.tickets_;
    const std::uint64_t ticket = lock_.next_ticket_++;
    tickets.push_back(ticket);
    const auto is_front = [&] { return tickets.front() == ticket; };
    if (is_front() || lock_.changed_.wait(mutex_lock, std::move(stop), is_front)) return;
    // No notification is needed: this ticket is not the front one, so its removal lets no other thread continue.
    tickets.erase(std::find(tickets.begin(), tickets.end(), ticket));
    throw Error(ErrorCode::cancelled, "cancelled");
}

TicketLock::Guard::~Guard() {
    const std::lock_guard mutex_lock(lock_.mutex_);
    lock_.tickets_.pop_front();
    if (!lock_.tickets_.empty()) lock_.changed_.notify_all();
}

}  // namespace octopair
