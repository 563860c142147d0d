// Check of calls that only count: compares the number of pairs with the number that the second algorithm finds.
#include <atomic>

#include "verification/result_check.hpp"
#include "verification/row_pass.hpp"

namespace octopair {

namespace {

class CountCheck final : public ResultCheck {
public:
    explicit CountCheck(const RowPass& pass) : pass_(pass) {}

    void take(std::span<const Pair>) override {}

    void finish(const CallEnd& end) override {
        std::atomic<std::uint64_t> all = 0;
        (void)pass_.run({0, pass_.rows().rows()}, Columns::any,
                        [&](std::uint32_t, std::span<const std::uint32_t> columns) {
                            all.fetch_add(columns.size(), std::memory_order_relaxed);
                            return ResultFault();
                        });
        if (end.truncated ? all > end.pairs : all == end.pairs) return;
        throw_verification_failed(std::to_string(end.pairs) + (end.truncated ? " pairs and more" : " pairs") +
                                  " were counted, but there are " + std::to_string(all));
    }

    std::string_view not_checked(const CallEnd&) const override { return "which pairs were counted"; }

private:
    const RowPass& pass_;
};

}  // namespace

std::unique_ptr<ResultCheck> make_count_check(const RowPass& pass) { return std::make_unique<CountCheck>(pass); }

}  // namespace octopair
