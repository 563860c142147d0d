// Budget: an amount that many take from and give back to, and that refuses to be overdrawn.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <utility>

namespace octopair::service {

class Budget {
public:
    /// Taken from a budget; given back when it goes.
    class Reservation {
    public:
        Reservation() = default;
        Reservation(Reservation&& other) noexcept
            : budget_(std::exchange(other.budget_, nullptr)), amount_(std::exchange(other.amount_, 0)) {}
        Reservation& operator=(Reservation&& other) noexcept {
            std::swap(budget_, other.budget_);
            std::swap(amount_, other.amount_);
            return *this;
        }
        ~Reservation() { give_back(); }

        std::uint64_t amount() const { return amount_; }
        /// Throws as Budget::take.
        void grow(std::uint64_t amount);
        void shrink(std::uint64_t amount) noexcept;
        void give_back() noexcept { shrink(amount_); }

    private:
        friend class Budget;
        Reservation(Budget& budget, std::uint64_t amount) : budget_(&budget), amount_(amount) {}

        Budget* budget_ = nullptr;
        std::uint64_t amount_ = 0;
    };

    /// `limit`: its name in messages (Limits); `unit`: as in "4 GiB bytes of memory". 0: there is no limit.
    Budget(std::string limit, std::string unit, std::uint64_t total);

    /// Throws a LimitError if more than there is would be taken. Thread-safe, as all here.
    Reservation take(std::uint64_t amount);
    /// Even if there is less: of what was taken before this budget was made.
    Reservation take_anyway(std::uint64_t amount);
    /// Throws a LimitError if take would always do, whoever gives back.
    void check(std::uint64_t amount) const;
    std::uint64_t taken() const;
    std::uint64_t total() const { return total_; }

private:
    void add(std::uint64_t amount);
    void give(std::uint64_t amount) noexcept;

    const std::string limit_, unit_;
    const std::uint64_t total_;
    mutable std::mutex mutex_;
    std::uint64_t taken_ = 0;
};

}  // namespace octopair::service
