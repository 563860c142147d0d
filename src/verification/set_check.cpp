// Check of results in any order. Each given pair is tested by the pair rule. A 128-bit hash of all given pairs is compared with that of
// the pairs that the second algorithm finds. The pairs of each object are also counted and hashed, to name the object whose pairs differ.
// Hashes are sums, so the order of the pairs does not matter.
#include <algorithm>
#include <atomic>
#include <optional>
#include <vector>

#include "verification/result_check.hpp"
#include "verification/row_pass.hpp"

namespace octopair {

namespace {

constexpr std::size_t pairs_per_task = 1 << 12;
constexpr std::uint64_t max_kept_pairs = 1 << 20;  // or the number of rows, if larger

/// The finaliser of splitmix64, by Steele, Lea and Flood 2014.
std::uint64_t mixed(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/// Returns a hash of b. Sums of these hashes differ for different sets, with high probability.
std::uint64_t hash_of(std::uint32_t b) { return mixed((std::uint64_t(b) + 1) * 0x9e3779b97f4a7c15u); }

/// A hash of a set of pairs: two sums mod 2^64 of independent hashes of each pair.
struct SetSum {
    std::uint64_t first = 0, second = 0;

    void add(const Pair& pair) {
        const std::uint64_t once = mixed((std::uint64_t(pair.a) << 32 | pair.b) + 0x9e3779b97f4a7c15u);
        first += once;
        second += mixed(once ^ 0xd1b54a32d192ed03u);
    }
    bool operator==(const SetSum&) const = default;
};

/// A SetSum that several threads add to.
class SharedSetSum {
public:
    void add(const SetSum& part) {
        first_.fetch_add(part.first, std::memory_order_relaxed);
        second_.fetch_add(part.second, std::memory_order_relaxed);
    }
    SetSum get() const { return {first_, second_}; }

private:
    std::atomic<std::uint64_t> first_ = 0, second_ = 0;
};

/// Number and hash of an object's pairs.
struct RowSum {
    std::uint64_t pairs = 0;
    std::uint64_t hash = 0;  ///< sum of the hashes of all b, mod 2^64

    void add(std::uint32_t b) {
        ++pairs;
        hash += hash_of(b);
    }
    bool operator==(const RowSum&) const = default;
};

RowSum sum_of(std::span<const std::uint32_t> columns) {
    RowSum sum;
    for (const std::uint32_t b : columns) sum.add(b);
    return sum;
}

class SetCheck final : public ResultCheck {
public:
    SetCheck(const RowPass& pass, std::optional<std::uint64_t> limit)
        : pass_(pass),
          pairs_(pass.rows().rows()),
          hashes_(pass.rows().rows()),
          keeps_(limit && *limit <= std::max<std::uint64_t>(max_kept_pairs, pass.rows().rows())) {}

    void take(std::span<const Pair> pairs) override {
        if (pairs.empty()) return;
        std::atomic<std::size_t> wrong = pairs.size();
        pass_.team().for_each((pairs.size() + pairs_per_task - 1) / pairs_per_task, [&](std::size_t task, unsigned) {
            const std::size_t end = std::min(pairs.size(), (task + 1) * pairs_per_task);
            SetSum part;
            for (std::size_t i = task * pairs_per_task; i < end; ++i) part.add(pairs[i]);
            given_.add(part);
            for (std::size_t i = task * pairs_per_task; i < std::min(end, wrong.load(std::memory_order_relaxed)); ++i) {
                if (take_one(pairs[i], i > 0 ? pairs[i - 1] : last_)) continue;
                for (std::size_t least = wrong; i < least && !wrong.compare_exchange_weak(least, i);) {
                }
            }
        });
        if (wrong < pairs.size()) throw_verification_failed(fault_of(pairs[wrong]));
        last_ = pairs.back();
        if (keeps_) kept_.insert(kept_.end(), pairs.begin(), pairs.end());
    }

    void finish(const CallEnd& end) override {
        if (end.truncated) check_kept_pairs();
        std::atomic<std::uint64_t> all = 0;
        SharedSetSum expected_sum;
        const auto compare = [&](std::uint32_t a, std::span<const std::uint32_t> columns) -> ResultFault {
            const RowSum expected = sum_of(columns);
            const RowSum given{pairs_[a], hashes_[a]};
            all.fetch_add(expected.pairs, std::memory_order_relaxed);
            SetSum part;
            for (const std::uint32_t b : columns) part.add({a, b});
            expected_sum.add(part);
            if (given == expected || (end.truncated && given.pairs < expected.pairs)) return {};
            return fault_of_row(a, {columns.begin(), columns.end()}, end);
        };
        if (ResultFault fault = pass_.run({0, pass_.rows().rows()}, Columns::any, compare))
            throw_verification_failed(*fault);
        if (!end.truncated && expected_sum.get() != given_.get()) {
            throw_verification_failed("the set of pairs has another hash than the set that the second algorithm finds");
        }
        if (end.truncated && all <= end.pairs) {
            throw_verification_failed("the result is said to be truncated, but no further pair exists");
        }
    }

    std::string_view not_checked(const CallEnd& end) const override {
        if (!end.truncated) return "the order of the pairs";
        return keeps_ ? "the order of the pairs, and which pairs are the first"
                      : "the order of the pairs, which pairs are the first, and that none was given twice";
    }

private:
    /// Throws if a kept pair was given twice. In a truncated result an object may lack pairs, so its sums do not show a duplicate.
    void check_kept_pairs() {
        std::sort(kept_.begin(), kept_.end());
        const auto twice = std::adjacent_find(kept_.begin(), kept_.end());
        if (twice != kept_.end()) throw_verification_failed(name_of_pair(*twice) + " was given twice");
    }

    /// Adds a pair to the sums. Returns false if the pair must not be in the result. `before`: the previous pair of the result.
    bool take_one(const Pair& pair, const std::optional<Pair>& before) {
        if (!has_position(pass_.rows(), pair) || !pass_.rows().is_pair(pair.a, pair.b) || before == pair) return false;
        std::atomic_ref(pairs_[pair.a]).fetch_add(1, std::memory_order_relaxed);
        std::atomic_ref(hashes_[pair.a]).fetch_add(hash_of(pair.b), std::memory_order_relaxed);
        return true;
    }

    std::string fault_of(const Pair& pair) const {
        if (!has_position(pass_.rows(), pair)) return fault_of_position(pass_.rows(), pair);
        const bool counts = pass_.rows().is_pair(pair.a, pair.b);
        return name_of_pair(pair) + (counts ? " was given twice" : " does not overlap");
    }

    std::string fault_of_row(std::uint32_t a, std::vector<std::uint32_t> expected, const CallEnd& end) const {
        std::sort(expected.begin(), expected.end());
        if (end.chunks.empty()) return fault_by_sums(a, expected);
        std::vector<std::uint32_t> given;
        for (const auto chunk : end.chunks) {
            for (const Pair& pair : chunk) {
                if (pair.a == a) given.push_back(pair.b);
            }
        }
        std::sort(given.begin(), given.end());
        const auto twice = std::adjacent_find(given.begin(), given.end());
        if (twice != given.end()) return name_of_pair({a, *twice}) + " was given twice";
        const auto [missing, other] = std::mismatch(expected.begin(), expected.end(), given.begin(), given.end());
        if (missing == expected.end()) return fault_of_count(a, expected.size());
        return name_of_pair({a, *missing}) + " is missing";
    }

    /// Describes the fault of an object's pairs if the pairs are not stored. If a single pair is missing or duplicate, its hash is the
    /// difference of the sums, so the pair can be named.
    std::string fault_by_sums(std::uint32_t a, std::span<const std::uint32_t> expected) const {
        const std::uint64_t lacks = sum_of(expected).hash - hashes_[a];
        for (const std::uint32_t b : expected) {
            if (expected.size() == pairs_[a] + 1ull && hash_of(b) == lacks) return name_of_pair({a, b}) + " is missing";
            if (pairs_[a] == expected.size() + 1 && hash_of(b) == 0 - lacks) {
                return name_of_pair({a, b}) + " was given twice";
            }
        }
        return fault_of_count(a, expected.size());
    }

    std::string fault_of_count(std::uint32_t a, std::size_t expected) const {
        const std::string object = "object " + std::to_string(a);
        if (pairs_[a] == expected) return "a pair of " + object + " is missing, and another was given twice";
        return object + " was given in " + std::to_string(pairs_[a]) + " pairs (a, b), but there are " +
               std::to_string(expected);
    }

    const RowPass& pass_;
    std::vector<std::uint32_t> pairs_;   // number of given pairs, by a
    std::vector<std::uint64_t> hashes_;  // sum of the hashes of the b of the given pairs, by a
    SharedSetSum given_;
    std::optional<Pair> last_;
    bool keeps_;
    std::vector<Pair> kept_;  // all given pairs, if `keeps_`: the limit is small
};

}  // namespace

std::unique_ptr<ResultCheck> make_set_check(const RowPass& pass, std::optional<std::uint64_t> limit) {
    return std::make_unique<SetCheck>(pass, limit);
}

}  // namespace octopair
