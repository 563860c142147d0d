#include "service/server/jobs/budget.hpp"

#include <algorithm>

#include "service/protocol/errors.hpp"

namespace octopair::service {

Budget::Budget(std::string limit, std::string unit, std::uint64_t total, std::uint64_t each)
    : limit_(std::move(limit)), unit_(std::move(unit)), total_(total), each_(each) {}

Budget::Reservation Budget::take(std::uint64_t amount, const std::string& client) {
    add(amount, client);
    return {*this, amount, client};
}

Budget::Reservation Budget::take_unchecked(std::uint64_t amount, const std::string& client) {
    const std::lock_guard lock(mutex_);
    add_unchecked(amount, client);
    return {*this, amount, client};
}

void Budget::check(std::uint64_t amount) const {
    if (total_ > 0 && amount > total_) {
        throw LimitError(limit_, total_,
                         limit_ + ": the server has " + std::to_string(total_) + " " + unit_ + "; " +
                             std::to_string(amount) + " are too many");
    }
    if (each_ > 0 && amount > each_) {
        throw LimitError(limit_ + "_per_client", each_,
                         limit_ + "_per_client: a client may have " + std::to_string(each_) + " " + unit_ + "; " +
                             std::to_string(amount) + " are too many");
    }
}

std::uint64_t Budget::taken() const {
    const std::lock_guard lock(mutex_);
    return taken_;
}

bool Budget::has(std::uint64_t amount, const std::string& client) const {
    const std::lock_guard lock(mutex_);
    const auto fits = [&](std::uint64_t most, std::uint64_t taken) {
        return most == 0 || (taken <= most && amount <= most - taken);
    };
    return fits(total_, taken_) && (client.empty() || fits(each_, of_client(client)));
}

/// Requires: mutex_ is held.
std::uint64_t Budget::of_client(const std::string& client) const {
    const auto known = of_clients_.find(client);
    return known == of_clients_.end() ? 0 : known->second;
}

void Budget::add(std::uint64_t amount, const std::string& client) {
    const std::lock_guard lock(mutex_);
    if (total_ > 0 && (taken_ > total_ || amount > total_ - taken_)) {
        throw LimitError(limit_, total_,
                         limit_ + ": the server has " + std::to_string(total_) + " " + unit_ + ", of which " +
                             std::to_string(taken_) + " are taken; " + std::to_string(amount) + " more are too many");
    }
    if (each_ > 0 && !client.empty()) {
        const std::uint64_t own = of_client(client);
        if (own > each_ || amount > each_ - own) {
            throw LimitError(limit_ + "_per_client", each_,
                             limit_ + "_per_client: a client may have " + std::to_string(each_) + " " + unit_ +
                                 ", of which " + std::to_string(own) + " are taken; " + std::to_string(amount) +
                                 " more are too many");
        }
    }
    add_unchecked(amount, client);
}

/// Requires: mutex_ is held.
void Budget::add_unchecked(std::uint64_t amount, const std::string& client) {
    if (each_ > 0 && !client.empty() && amount > 0) of_clients_[client] += amount;
    taken_ += amount;
}

void Budget::give(std::uint64_t amount, const std::string& client) noexcept {
    const std::lock_guard lock(mutex_);
    taken_ -= amount;
    const auto known = of_clients_.find(client);
    if (known == of_clients_.end()) return;
    known->second -= amount;
    if (known->second == 0) of_clients_.erase(known);
}

void Budget::Reservation::grow(std::uint64_t amount) {
    if (budget_ == nullptr) return;
    budget_->add(amount, client_);
    amount_ += amount;
}

void Budget::Reservation::shrink(std::uint64_t amount) noexcept {
    if (budget_ == nullptr) return;
    amount = std::min(amount, amount_);
    budget_->give(amount, client_);
    amount_ -= amount;
}

}  // namespace octopair::service
