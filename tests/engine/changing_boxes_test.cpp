// Tests calls whose boxes another thread overwrites meanwhile, as another program may overwrite a mapped file. The result is arbitrary,
// or an error. Memory must stay intact, which the address sanitizer checks, and the call must end.
#include <gtest/gtest.h>

#include <algorithm>
#include <thread>
#include <vector>

#include "octopair/octopair.hpp"
#include "support/hostile_boxes.hpp"
#include "support/kinds.hpp"

namespace octopair::test {
namespace {

constexpr std::uint64_t changing_box_count = 4000;

/// Number of boxes that change. Each may become as large as the world, and then forms a pair with every other box.
constexpr std::size_t overwritten = 100;

/// Overwrites boxes until it is destroyed.
template <typename Real>
class OverwritingThread {
public:
    OverwritingThread(std::span<Box<Real>> boxes, Hostility hostility) : overwriter_(boxes, hostility, 1) {
        thread_ = std::jthread([this](const std::stop_token& stop) {
            while (!stop.stop_requested()) overwriter_.overwrite_one();
        });
    }

private:
    BoxOverwriter<Real> overwriter_;
    std::jthread thread_;
};

/// Makes calls of all kinds. Returns the number of calls that gave a result.
template <typename Real>
unsigned call_all(Engine& engine, std::span<const Box<Real>> boxes) {
    unsigned results = 0;
    const Input input{Objects{boxes}};
    const auto check = [](std::span<const Pair> pairs) {
        for (const Pair& pair : pairs) ASSERT_LT(std::max(pair.a, pair.b), changing_box_count);
    };
    const auto attempt = [&](const auto& call) {
        try {
            call();
            ++results;
        } catch (const Error& error) {
            EXPECT_TRUE(error.code() == ErrorCode::bad_input || error.code() == ErrorCode::engine_failed)
                << error.what();
        }
    };
    PairList list;
    for (const Order order : {Order::ascending, Order::octal}) {
        Options options{.order = order};
        options.limit = 20 * changing_box_count;  // boxes of the whole world would form millions of pairs
        attempt([&] {
            (void)engine.find_pairs(input, list, options);
            for (const auto chunk : list.chunks()) check(chunk);
        });
        options.margin = 0.01;
        options.buffer_bytes = 1;  // the least: many windows
        attempt([&] { (void)engine.stream_pairs(input, PairSink(check), options); });
    }
    attempt([&] { (void)engine.count_pairs(input); });
    Options verified{.limit = 100, .verify = true};
    attempt([&] { (void)engine.find_pairs(input, list, verified); });
    return results;
}

template <typename Real>
void overwrite_during_calls(const std::vector<Box<Real>>& made, Hostility hostility) {
    const auto engine = make_local_engine(2);
    std::vector<Box<Real>> boxes = made;
    unsigned results = 0;
    for (int round = 0; round < 3; ++round) {
        std::ranges::copy(made, boxes.begin());
        const OverwritingThread<Real> thread({boxes.data(), overwritten}, hostility);
        results += call_all<Real>(*engine, boxes);
        if (::testing::Test::HasFatalFailure()) return;
    }
    if (hostility == Hostility::valid) {
        EXPECT_GT(results, 0u);
    }
}

class ChangingBoxes : public ::testing::TestWithParam<std::string> {};

TEST_P(ChangingBoxes, EndCallsWithoutDamage) {
    for (const Hostility hostility : {Hostility::valid, Hostility::any}) {
        overwrite_during_calls(make_boxes(GetParam(), changing_box_count, 1), hostility);
        overwrite_during_calls(make_double_boxes(GetParam(), changing_box_count, 1), hostility);
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds, ChangingBoxes, ::testing::Values("uniform", "clustered", "rods"));

}  // namespace
}  // namespace octopair::test
