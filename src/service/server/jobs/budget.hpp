// Budget: a limited amount of a resource. Users reserve parts of the amount; a reservation beyond the limit is refused. A client has a
// limit of its own, so that one client cannot take everything.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <utility>

namespace octopair::service {

class Budget {
public:
    /// An amount taken from a budget. The destructor gives it back.
    class Reservation {
    public:
        Reservation() = default;
        Reservation(Reservation&& other) noexcept
            : budget_(std::exchange(other.budget_, nullptr)),
              amount_(std::exchange(other.amount_, 0)),
              client_(std::move(other.client_)) {}
        Reservation& operator=(Reservation&& other) noexcept {
            std::swap(budget_, other.budget_);
            std::swap(amount_, other.amount_);
            std::swap(client_, other.client_);
            return *this;
        }
        ~Reservation() { give_back(); }

        std::uint64_t amount() const { return amount_; }
        /// Throws: as Budget::take.
        void grow(std::uint64_t amount);
        void shrink(std::uint64_t amount) noexcept;
        void give_back() noexcept { shrink(amount_); }

    private:
        friend class Budget;
        Reservation(Budget& budget, std::uint64_t amount, std::string client)
            : budget_(&budget), amount_(amount), client_(std::move(client)) {}

        Budget* budget_ = nullptr;
        std::uint64_t amount_ = 0;
        std::string client_;
    };

    /// `limit`: name of the limit in messages, as in octopair.proto's Limits. `unit`: noun that follows the number in messages,
    /// as in "bytes of memory". `total`: size of the budget. `each`: what one client may take. 0: unlimited.
    Budget(std::string limit, std::string unit, std::uint64_t total, std::uint64_t each = 0);

    /// Reserves `amount` for a client. With an empty name, only the limit of the whole budget applies. Throws: LimitError if less than
    /// `amount` is left. Thread safety: any thread may call any member of Budget.
    Reservation take(std::uint64_t amount, const std::string& client = {});
    /// Reserves `amount` even beyond the limits. For resources that were in use before this budget existed.
    Reservation take_unchecked(std::uint64_t amount, const std::string& client = {});
    /// Throws: LimitError if `amount` is more than a client or the whole budget may have, so that take() can never succeed.
    void check(std::uint64_t amount) const;
    /// Returns whether take() would succeed now.
    bool has(std::uint64_t amount, const std::string& client) const;
    std::uint64_t taken() const;
    /// Returns the limit of each client; 0: none.
    std::uint64_t each() const { return each_; }

private:
    std::uint64_t of_client(const std::string& client) const;
    void add(std::uint64_t amount, const std::string& client);
    void add_unchecked(std::uint64_t amount, const std::string& client);
    void give(std::uint64_t amount, const std::string& client) noexcept;

    const std::string limit_, unit_;
    const std::uint64_t total_, each_;
    mutable std::mutex mutex_;
    std::uint64_t taken_ = 0;
    std::map<std::string, std::uint64_t> of_clients_;  // clients that have taken something
};

}  // namespace octopair::service
