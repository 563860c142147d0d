// Check of ascending results. A row is all pairs (a, b) of one object a. Each complete row of the result is compared with the row that the
// second algorithm (row_search.hpp) finds.
#include <algorithm>
#include <atomic>
#include <optional>
#include <vector>

#include "verification/result_check.hpp"
#include "verification/row_pass.hpp"

namespace octopair {

namespace {

constexpr std::size_t pairs_at_once = 1 << 16;

/// Returns the first difference between the expected and the given pairs of a row, both ascending. With `prefix`, `given` may
/// be the beginning of the row.
ResultFault difference(std::uint32_t a, std::span<const std::uint32_t> expected, std::span<const Pair> given,
                       bool prefix = false) {
    std::size_t i = 0;
    while (i < given.size() && i < expected.size() && given[i].b == expected[i]) ++i;
    if (i == given.size()) {
        if (prefix || i == expected.size()) return {};
        return name_of_pair({a, expected[i]}) + " is missing";
    }
    if (i == expected.size() || given[i].b < expected[i]) return name_of_pair({a, given[i].b}) + " does not overlap";
    return name_of_pair({a, expected[i]}) + " is missing";
}

class AscendingCheck final : public ResultCheck {
public:
    explicit AscendingCheck(const RowPass& pass) : pass_(pass) {}

    void take(std::span<const Pair> pairs) override {
        while (!pairs.empty()) {
            const auto some = pairs.first(std::min(pairs.size(), pairs_at_once));
            for (const Pair& pair : some) check_order(pair);
            held_.insert(held_.end(), some.begin(), some.end());
            if (held_.size() >= pairs_at_once && held_.back().a > next_row_) compare_rows(held_.back().a);
            pairs = pairs.subspan(some.size());
        }
    }

    void finish(const CallEnd& end) override {
        if (!end.truncated) return compare_rows(pass_.rows().rows());
        if (last_) compare_rows(last_->a);
        compare_prefix();
    }

    std::string_view not_checked(const CallEnd&) const override { return {}; }

private:
    void check_order(const Pair& pair) {
        if (!has_position(pass_.rows(), pair)) throw_verification_failed(fault_of_position(pass_.rows(), pair));
        if (last_ && *last_ == pair) throw_verification_failed(name_of_pair(pair) + " was given twice");
        if (last_ && pair < *last_) {
            throw_verification_failed(name_of_pair(pair) + " comes after " + name_of_pair(*last_));
        }
        last_ = pair;
    }

    /// Compares the rows before `end` that were not compared yet, and drops their pairs. Requires: take() has received all pairs of
    /// these rows.
    void compare_rows(std::uint32_t end) {
        const auto compare = [&](std::uint32_t a, std::span<const std::uint32_t> expected) {
            const auto [begin, after] = std::equal_range(held_.begin(), held_.end(), Pair{a, 0}, by_row);
            return difference(a, expected, {begin, after});
        };
        if (ResultFault fault = pass_.run({next_row_, end}, Columns::ascending, compare)) {
            throw_verification_failed(*fault);
        }
        next_row_ = end;
        held_.erase(held_.begin(), std::lower_bound(held_.begin(), held_.end(), Pair{end, 0}, by_row));
    }

    /// Compares the last row of a truncated result. Checks that at least one more pair exists.
    void compare_prefix() {
        std::atomic<bool> more = false;
        if (last_) {
            const auto compare = [&](std::uint32_t a, std::span<const std::uint32_t> expected) {
                more = expected.size() > held_.size();
                return difference(a, expected, held_, true);
            };
            if (ResultFault fault = pass_.run({last_->a, last_->a + 1}, Columns::ascending, compare)) {
                throw_verification_failed(*fault);
            }
        }
        const auto look = [&](std::uint32_t, std::span<const std::uint32_t> columns) {
            if (!columns.empty()) more = true;
            return ResultFault();
        };
        constexpr std::uint32_t rows_at_once = 1 << 12;
        const std::uint32_t rows = pass_.rows().rows();
        for (std::uint32_t row = last_ ? last_->a + 1 : 0; row < rows && !more;) {
            const std::uint32_t end = row + std::min(rows - row, rows_at_once);
            (void)pass_.run({row, end}, Columns::any, look);
            row = end;
        }
        if (!more) throw_verification_failed("the result is said to be truncated, but no further pair exists");
    }

    static bool by_row(const Pair& left, const Pair& right) { return left.a < right.a; }

    const RowPass& pass_;
    std::vector<Pair> held_;  // pairs of rows from next_row_ on, ascending
    std::uint32_t next_row_ = 0;
    std::optional<Pair> last_;
};

}  // namespace

std::unique_ptr<ResultCheck> make_ascending_check(const RowPass& pass) {
    return std::make_unique<AscendingCheck>(pass);
}

}  // namespace octopair
