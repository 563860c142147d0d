#include "service/server/jobs/budget.hpp"

#include <algorithm>

#include "service/protocol/limit_error.hpp"

namespace octopair::service {

Budget::Budget(std::string limit, std::string unit, std::uint64_t total)
    : limit_(std::move(limit)), unit_(std::move(unit)), total_(total) {}

Budget::Reservation Budget::take(std::uint64_t amount) {
    add(amount);
    return {*this, amount};
}

Budget::Reservation Budget::take_unchecked(std::uint64_t amount) {
    const std::lock_guard lock(mutex_);
    taken_ += amount;
    return {*this, amount};
}

void Budget::check(std::uint64_t amount) const {
    if (total_ == 0 || amount <= total_) return;
    throw LimitError(limit_, total_,
                     limit_ + ": the server has " + std::to_string(total_) + " " + unit_ + "; " +
                         std::to_string(amount) + " are too many");
}

std::uint64_t Budget::taken() const {
    const std::lock_guard lock(mutex_);
    return taken_;
}

void Budget::add(std::uint64_t amount) {
    const std::lock_guard lock(mutex_);
    if (total_ > 0 && (taken_ > total_ || amount > total_ - taken_)) {
        throw LimitError(limit_, total_,
                         limit_ + ": the server has " + std::to_string(total_) + " " + unit_ + ", of which " +
                             std::to_string(taken_) + " are taken; " + std::to_string(amount) + " more are too many");
    }
    taken_ += amount;
}

void Budget::give(std::uint64_t amount) noexcept {
    const std::lock_guard lock(mutex_);
    taken_ -= amount;
}

void Budget::Reservation::grow(std::uint64_t amount) {
    if (budget_ == nullptr) return;
    budget_->add(amount);
    amount_ += amount;
}

void Budget::Reservation::shrink(std::uint64_t amount) noexcept {
    if (budget_ == nullptr) return;
    amount = std::min(amount, amount_);
    budget_->give(amount);
    amount_ -= amount;
}

}  // namespace octopair::service
