#include "exactness/case_check.hpp"

#include <algorithm>
#include <map>
#include <memory>

#include "baselines/baselines.hpp"
#include "support/compare.hpp"
#include "verification/row_search.hpp"

namespace octopair::test {

namespace {

std::uint64_t objects_of(const Case& a_case) {
    return a_case.first.view().size() + (a_case.second ? a_case.second->view().size() : 0);
}

/// A call on the objects of a case.
struct Call {
    const Case& asked;
    Objects first, second;
    Options options = {};

    explicit Call(const Case& a_case) : asked(a_case), first(a_case.first.view()) {
        if (a_case.second) second = a_case.second->view();
        options.margin = a_case.margin;
    }
    Call& in(Order order) {
        options.order = order;
        return *this;
    }
    Call& limited() {
        options.limit = asked.limit;
        return *this;
    }

    Summary find(Engine& engine, std::vector<Pair>& found) const {
        PairList list;
        const Summary summary = engine.find_pairs(asked.input(), list, options);
        found = list.to_vector();
        return summary;
    }
    Summary stream(Engine& engine, std::vector<Pair>& found) {
        options.buffer_bytes = asked.buffer_bytes;
        return engine.stream_pairs(asked.input(), into(found), options);
    }
    Summary stream_at_most(std::uint64_t most, Engine& engine, std::vector<Pair>& found) {
        options.buffer_bytes = asked.buffer_bytes;
        return engine.stream_at_most(most, asked.input(), into(found), options);
    }
    std::uint64_t count(Engine& engine) const { return engine.count_pairs(asked.input(), options); }

    static PairSink into(std::vector<Pair>& found) {
        found.clear();
        return [&](std::span<const Pair> batch) { found.insert(found.end(), batch.begin(), batch.end()); };
    }
};

/// Makes the calls on a case. Throws the first Finding.
class CaseCheck {
public:
    CaseCheck(const Case& a_case, const std::vector<Pair>& expected, const EngineFor& engines)
        : case_(a_case), expected_(expected), engines_(engines) {}

    void check_lists() {
        std::vector<Pair> found;
        const Summary summary = Call(case_).in(Order::ascending).find(engine(0), found);
        expect_set("ascending", found);
        expect("entries", summary.entries <= 8 * objects_of(case_), "more than 8 entries per object");
        expect("summary", summary.pairs == found.size() && !summary.truncated, "the summary differs from the list");
        (void)Call(case_).in(Order::octal).find(engine(1), octal_);
        found = octal_;
        std::sort(found.begin(), found.end());
        expect_set("octal", found);
    }
    void check_count() {
        const std::uint64_t pairs = Call(case_).in(Order::octal).count(engine(0));
        expect("count", pairs == expected_.size(),
               std::to_string(pairs) + " pairs counted, not " + std::to_string(expected_.size()));
    }
    void check_threads() {
        std::vector<Pair> found;
        (void)Call(case_).in(Order::octal).find(engine(2), found);
        expect_bytes("octal order by threads", found, octal_);
        (void)Call(case_).in(Order::ascending).find(engine(1), found);
        expect_bytes("ascending order by threads", found, expected_);
    }
    void check_limits() {
        for (const Order order : {Order::ascending, Order::octal}) {
            std::vector<Pair> found;
            const Summary summary = Call(case_).in(order).limited().find(engine(1), found);
            expect_bytes("limit", found, first(all(order)));
            expect("truncated", summary.truncated == (all(order).size() > case_.limit), "truncated is wrong");
        }
        const std::uint64_t pairs = Call(case_).limited().count(engine(2));
        expect("limited count", pairs == std::min<std::uint64_t>(expected_.size(), case_.limit), "a wrong count");
    }
    void check_streams() {
        for (const Order order : {Order::ascending, Order::octal}) {
            std::vector<Pair> found;
            (void)Call(case_).in(order).stream(engine(2), found);
            expect_bytes("stream", found, all(order));
            (void)Call(case_).in(order).limited().stream(engine(0), found);
            expect_bytes("limited stream", found, first(all(order)));
            check_bounded(order);
        }
    }

private:
    /// Engine::stream_at_most() delivers all pairs, or fails if they are more. An error that has the number of pairs has the right
    /// number.
    void check_bounded(Order order) {
        std::vector<Pair> found;
        try {
            (void)Call(case_).in(order).stream_at_most(case_.limit, engine(1), found);
            expect_bytes("bounded stream", found, all(order));
        } catch (const TooManyPairs& excess) {
            const std::uint64_t pairs = all(order).size();
            expect("bound", pairs > case_.limit, "refused without need");
            expect("count of a refusal", excess.exact() ? excess.pairs() == pairs : excess.pairs() < pairs,
                   "a wrong count");
            expect("refused stream", found.size() <= case_.limit, "more pairs than the bound");
        }
        expect("bound kept", found.size() <= case_.limit, "more pairs than the bound");
    }

    Engine& engine(std::size_t i) const { return engines_(case_.threads[i]); }
    const std::vector<Pair>& all(Order order) const { return order == Order::ascending ? expected_ : octal_; }
    std::vector<Pair> first(const std::vector<Pair>& all) const {
        return {all.begin(), all.begin() + std::ptrdiff_t(std::min<std::uint64_t>(all.size(), case_.limit))};
    }

    static void expect(const char* check, bool holds, const std::string& otherwise) {
        if (!holds) throw Finding{check, otherwise};
    }
    static void expect(const char* check, const ::testing::AssertionResult& result) {
        expect(check, bool(result), result ? "" : result.message());
    }
    void expect_set(const std::string& order, const std::vector<Pair>& found) const {
        const bool twice = std::adjacent_find(found.begin(), found.end()) != found.end();
        const Objects first = case_.first.view(), second = case_.second ? case_.second->view() : Objects{};
        const Searched where{first, case_.second ? &second : nullptr};
        const std::string check = order + (twice ? ": pairs given twice" : ": another set of pairs");
        expect(check.c_str(), same_pairs(found, expected_, where));
    }
    static void expect_bytes(const char* check, const std::vector<Pair>& found, const std::vector<Pair>& all) {
        expect(check, same_bytes(found, all));
    }

    const Case& case_;
    const std::vector<Pair>& expected_;
    const EngineFor& engines_;
    std::vector<Pair> octal_;
};

}  // namespace

std::vector<Pair> brute_force_pairs(const Case& a_case) {
    return a_case.second ? baselines::oracle_pairs_between(a_case.first.view(), a_case.second->view(), a_case.margin)
                         : baselines::oracle_pairs(a_case.first.view(), a_case.margin);
}

std::vector<Pair> second_algorithm_pairs(const Case& a_case) {
    static Team team(2);
    const Objects first = a_case.first.view(), second = a_case.second ? a_case.second->view() : Objects{};
    const RowSearch search({first, a_case.second ? &second : nullptr, a_case.margin}, team);
    std::vector<Pair> pairs;
    std::vector<std::uint32_t> columns;
    for (std::uint32_t a = 0; a < search.rows(); ++a) {
        search.row(a, columns);
        for (const std::uint32_t b : columns) pairs.push_back({a, b});
    }
    return pairs;
}

EngineFor local_engines() {
    const auto engines = std::make_shared<std::map<unsigned, std::unique_ptr<Engine>>>();
    return [engines](unsigned threads) -> Engine& {
        std::unique_ptr<Engine>& engine = (*engines)[threads];
        if (!engine) engine = make_local_engine(threads);
        return *engine;
    };
}

std::optional<Finding> check_case(const Case& a_case, const std::vector<Pair>& expected, const EngineFor& engines,
                                  Calls calls) {
    try {
        CaseCheck check(a_case, expected, engines);
        check.check_lists();
        check.check_count();
        if (calls == Calls::few) return {};
        check.check_threads();
        check.check_limits();
        check.check_streams();
    } catch (const Finding& finding) {
        return finding;
    } catch (const Error& error) {
        return Finding{"an error", error.what()};
    }
    return {};
}

}  // namespace octopair::test
