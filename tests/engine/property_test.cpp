// Tests the local engine against the oracle on random calls: 300 cases for each of 34 kinds.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "baselines/baselines.hpp"
#include "support/cases.hpp"
#include "support/compare.hpp"
#include "support/kinds.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

constexpr std::uint64_t cases_per_kind = scaled(300, 10);
constexpr std::uint64_t min_buffer = 1 << 20;  // smaller values of Options::buffer_bytes are raised to this

/// Returns the engine for a number of threads. All cases reuse the engine, so that state left by a call would show in
/// the next case.
Engine& engine_of(unsigned threads) {
    static std::map<unsigned, std::unique_ptr<Engine>> engines;
    std::unique_ptr<Engine>& engine = engines[threads];
    if (!engine) engine = make_local_engine(threads);
    return *engine;
}

/// Makes the calls of an engine on the objects of a case with one or two sets.
class Calls {
public:
    explicit Calls(const Case& a_case) : case_(a_case), first_(a_case.first.view()) {
        if (case_.second) second_ = case_.second->view();
    }

    std::vector<Pair> expected() const {
        return second_ ? baselines::oracle_pairs_between(first_, *second_, case_.margin)
                       : baselines::oracle_pairs(first_, case_.margin);
    }
    Searched searched() const { return {first_, second_ ? &*second_ : nullptr}; }

    Options options(Order order) const {
        Options options{.order = order, .margin = case_.margin};
        return options;
    }

    Summary find(unsigned threads, const Options& options, std::vector<Pair>& found) {
        Engine& engine = engine_of(threads);
        const Summary summary = engine.find_pairs(case_.input(), list_, options);
        found = list_.to_vector();
        EXPECT_EQ(summary.pairs, found.size());
        EXPECT_EQ(list_.size(), found.size());
        EXPECT_LE(summary.entries, 8 * (first_.size() + (second_ ? second_->size() : 0)));
        return summary;
    }

    Summary stream(unsigned threads, const Options& options, std::vector<Pair>& found) {
        Engine& engine = engine_of(threads);
        const std::uint64_t bound = std::max(options.buffer_bytes, min_buffer);
        const PairSink sink = [&](std::span<const Pair> batch) {
            EXPECT_LE(batch.size_bytes(), bound);
            found.insert(found.end(), batch.begin(), batch.end());
        };
        return engine.stream_pairs(case_.input(), sink, options);
    }

    std::uint64_t count(unsigned threads, const Options& options) {
        Engine& engine = engine_of(threads);
        return engine.count_pairs(case_.input(), options);
    }

private:
    const Case& case_;
    Objects first_;
    std::optional<Objects> second_;
    PairList list_;
};

void check_limit(const Case& a_case, Calls& calls, Order order, const std::vector<Pair>& all) {
    Options options = calls.options(order);
    options.limit = a_case.limit;
    std::vector<Pair> found;
    const Summary summary = calls.find(a_case.threads[1], options, found);
    EXPECT_EQ(summary.truncated, all.size() > a_case.limit);
    const std::vector<Pair> first(all.begin(), all.begin() + std::ptrdiff_t(std::min(all.size(), a_case.limit)));
    EXPECT_TRUE(same_bytes(found, first)) << "with a limit, order " << int(order);
}

void check_stream(const Case& a_case, Calls& calls, Order order, const std::vector<Pair>& all) {
    Options options = calls.options(order);
    options.buffer_bytes = a_case.buffer_bytes;
    std::vector<Pair> found;
    const Summary summary = calls.stream(a_case.threads[2], options, found);
    EXPECT_EQ(summary.pairs, found.size());
    EXPECT_FALSE(summary.truncated);
    EXPECT_TRUE(same_bytes(found, all)) << "streamed, order " << int(order);
}

void check_count(const Case& a_case, Calls& calls, std::uint64_t pairs) {
    Options options = calls.options(Order::octal);
    EXPECT_EQ(calls.count(a_case.threads[0], options), pairs);
    options.limit = a_case.limit;
    EXPECT_EQ(calls.count(a_case.threads[1], options), std::min(pairs, a_case.limit));
}

/// Makes all calls of an engine on the objects of one case.
void check_case(const Case& a_case) {
    Calls calls(a_case);
    const std::vector<Pair> expected = calls.expected();
    std::vector<Pair> ascending, octal, again;
    EXPECT_FALSE(calls.find(a_case.threads[0], calls.options(Order::ascending), ascending).truncated);
    ASSERT_TRUE(same_pairs(ascending, expected, calls.searched())) << "ascending";
    EXPECT_FALSE(calls.find(a_case.threads[1], calls.options(Order::octal), octal).truncated);
    ASSERT_TRUE(same_pairs(baselines::ascending(octal), expected, calls.searched())) << "octal";
    calls.find(a_case.threads[2], calls.options(Order::octal), again);
    EXPECT_TRUE(same_bytes(again, octal)) << "octal, with another number of threads";
    check_limit(a_case, calls, Order::ascending, expected);
    check_limit(a_case, calls, Order::octal, octal);
    check_stream(a_case, calls, Order::ascending, expected);
    check_stream(a_case, calls, Order::octal, octal);
    check_count(a_case, calls, expected.size());
}

class EngineProperty : public ::testing::TestWithParam<std::string> {};

TEST_P(EngineProperty, AgreesWithTheOracle) {
    const std::uint64_t cases = case_count(cases_per_kind);
    for (std::uint64_t i = 0; i < cases && !HasFailure(); ++i) {
        const std::uint64_t seed = case_seed(GetParam(), i);
        const Case a_case = make_case(GetParam(), seed);
        SCOPED_TRACE(a_case.describe() + "; replay with OCTOPAIR_TEST_SEED=" + std::to_string(seed));
        check_case(a_case);
    }
}

INSTANTIATE_TEST_SUITE_P(, EngineProperty, ::testing::ValuesIn(all_kind_names()), param_name);

}  // namespace
}  // namespace octopair::test
