// Tests Options::verify: correct results of the local engine pass, and a call of an engine with wrong results throws.
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/job_queue.hpp"
#include "engine/pair_list.hpp"
#include "engine/request.hpp"
#include "support/cases.hpp"
#include "support/compare.hpp"
#include "support/errors.hpp"
#include "support/kinds.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

class VerifiedKind : public ::testing::TestWithParam<std::string> {};

TEST_P(VerifiedKind, EveryCallPasses) {
    const auto engine = make_local_engine(2);
    for (std::uint64_t i = 0; i < case_count(scaled(12, 2)); ++i) {
        const Case asked = make_case(GetParam(), case_seed(GetParam(), i));
        for (unsigned way = 0; way < 8; ++way) {
            const AnyCall call{asked, way & 1 ? Order::octal : Order::ascending, (way & 2) != 0, (way & 4) != 0};
            AnyCall verified = call;
            verified.verify = true;
            EXPECT_TRUE(same_bytes(verified.made_by(*engine), call.made_by(*engine))) << asked.describe();
            EXPECT_EQ(verified.counted_by(*engine), call.counted_by(*engine)) << asked.describe();
        }
        ASSERT_FALSE(HasFailure()) << asked.describe();
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds, VerifiedKind, ::testing::ValuesIn(all_kind_names()), param_name);

/// Finds pairs with another engine, then repeats a pair, omits a pair, or reports a wrong number.
class WrongEngine final : public Engine {
public:
    enum class Wrong { nothing, twice, missing, counted } wrong = Wrong::nothing;
    Pair named = {};  ///< the pair that is repeated or omitted

private:
    Summary run(const detail::Request& request, const detail::Output& output, const detail::Control& control) override {
        Options options = request.options;
        options.verify = false;
        PairList found;
        Summary summary = inner_->find_pairs(request.first, found, options, control.stop);
        std::vector<Pair> pairs = found.to_vector();
        const auto place = pairs.begin() + std::ptrdiff_t(pairs.size() / 2);
        named = *place;
        if (wrong == Wrong::twice) pairs.insert(pairs.begin() + std::ptrdiff_t(pairs.size() / 2), named);
        if (wrong == Wrong::missing) pairs.erase(place);
        summary.pairs = pairs.size() + (wrong == Wrong::counted ? 1 : 0);
        if (output.list != nullptr) {
            detail::PairStorage& list = detail::storage_of(*output.list);
            list.append(list.copy(pairs));
        }
        if (output.sink != nullptr) (*output.sink)(pairs);
        return summary;
    }
    detail::JobQueue& jobs() override { return jobs_; }

    std::unique_ptr<Engine> inner_ = make_local_engine(1);
    detail::JobQueue jobs_{*this};
};

class VerifiedWrongEngine : public ::testing::TestWithParam<Order> {
protected:
    Options verifying() const {
        Options options{.order = GetParam(), .verify = true};
        return options;
    }
    template <typename Call>
    void expect_failure(const std::string& words, const Call& call) const {
        const std::string message = error_of(ErrorCode::engine_failed, call);
        const std::string pair =
            "pair (" + std::to_string(engine_.named.a) + ", " + std::to_string(engine_.named.b) + ")";
        EXPECT_EQ(message, "verification failed: " + (words[0] == ' ' ? pair : "") + words);
    }

    std::vector<Box3f> boxes_ = make_boxes("dense", 500, 5);
    Objects objects_{boxes_, {}};
    mutable WrongEngine engine_;
};

TEST_P(VerifiedWrongEngine, IsRightWithoutAnError) {
    PairList list;
    const Summary summary = engine_.find_pairs(objects_, list, verifying());
    EXPECT_TRUE(summary.verification.done);
    EXPECT_GT(summary.verification.seconds, 0);
    EXPECT_EQ(summary.verification.not_checked.empty(), GetParam() == Order::ascending);
    EXPECT_FALSE(engine_.find_pairs(objects_, list).verification.done);
}

TEST_P(VerifiedWrongEngine, FailsAndNamesThePair) {
    for (const auto& [wrong, words] : {std::pair(WrongEngine::Wrong::twice, " was given twice"),
                                       std::pair(WrongEngine::Wrong::missing, " is missing")}) {
        engine_.wrong = wrong;
        PairList list;
        expect_failure(words, [&] { (void)engine_.find_pairs(objects_, list, verifying()); });
        EXPECT_EQ(list.size(), 0u);
        expect_failure(words, [&] {
            (void)engine_.stream_pairs(
                objects_, [](auto) {}, verifying());
        });
        Job job = engine_.submit(borrowed(objects_), verifying());
        expect_failure(words, [&] { (void)job.take_pairs(); });
        Job stream = engine_.submit_stream(
            borrowed(objects_), [](auto) {}, verifying());
        expect_failure(words, [&] { (void)stream.summary(); });
        EXPECT_NO_THROW((void)engine_.find_pairs(objects_, list)) << "not verified";
    }
}

TEST_P(VerifiedWrongEngine, AWrongBatchIsNotHandedOut) {
    engine_.wrong = WrongEngine::Wrong::twice;
    bool handed_out = false;
    expect_failure(" was given twice", [&] {
        (void)engine_.stream_pairs(
            objects_, [&](auto) { handed_out = true; }, verifying());
    });
    EXPECT_FALSE(handed_out);
}

TEST_P(VerifiedWrongEngine, FailsByItsNumbers) {
    engine_.wrong = WrongEngine::Wrong::counted;
    PairList list;
    const std::uint64_t pairs = make_local_engine(1)->count_pairs(objects_);
    expect_failure(
        "the summary says " + std::to_string(pairs + 1) + " pairs, but " + std::to_string(pairs) + " were given",
        [&] { (void)engine_.find_pairs(objects_, list, verifying()); });
    expect_failure(std::to_string(pairs + 1) + " pairs were counted, but there are " + std::to_string(pairs),
                   [&] { (void)engine_.count_pairs(objects_, verifying()); });
}

INSTANTIATE_TEST_SUITE_P(Orders, VerifiedWrongEngine, ::testing::Values(Order::ascending, Order::octal));

TEST(Verified, ShortFormAndProgress) {
    const std::vector<Box3f> boxes = make_boxes("uniform", 3000, 1);
    for (const bool counted : {false, true}) {
        std::vector<double> told;
        Options options{.verify = true};
        options.progress = [&](double done) { told.push_back(done); };
        if (counted) {
            (void)make_local_engine(2)->count_pairs({boxes, {}}, options);
        } else {
            (void)find_pairs(std::span(boxes), options);
        }
        EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
        ASSERT_FALSE(told.empty());
        EXPECT_EQ(told.back(), 1);
        EXPECT_GE(told.front(), 0);
    }
}

TEST(Verified, RefusesABadBox) {
    std::vector<Box3f> boxes = make_boxes("uniform", 3000, 1);
    boxes[7].min[0] = 1e9f;
    Options options{.verify = true};
    (void)error_of(ErrorCode::bad_input, [&] { (void)find_pairs(std::span<const Box3f>(boxes), options); });
}

TEST(Verified, StopsWhenAsked) {
    // One thread checks 16,384 objects between two reports of progress.
    std::vector<Box3f> boxes(20'000);
    for (std::size_t i = 0; i < boxes.size(); ++i) boxes[i] = {{2 * float(i), 0, 0}, {2 * float(i) + 1, 1, 1}};
    std::stop_source stop;
    Options options{.verify = true};
    options.progress = [&](double done) {
        if (done > 0.31) stop.request_stop();
    };
    const auto engine = make_local_engine(1);
    (void)error_of(ErrorCode::cancelled, [&] { (void)engine->count_pairs({boxes, {}}, options, stop.get_token()); });
}

}  // namespace
}  // namespace octopair::test
