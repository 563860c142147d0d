// Tests that clients take turns: one with many jobs does not make the others wait for all of them.
#include <gtest/gtest.h>

#include "service/gate.hpp"
#include "service/guarded.hpp"
#include "service/served.hpp"
#include "service/server/jobs/fair_order.hpp"
#include "support/kinds.hpp"

namespace octopair::test {
namespace {

using service::FairOrder;

TEST(FairOrder, ClientsTakeTurns) {
    FairOrder order;
    for (int i = 0; i < 10; ++i) order.begin("greedy", 100);
    EXPECT_LT(order.start_of("polite"), order.start_of("greedy"));
    order.begin("polite", 100);
    EXPECT_GT(order.start_of("polite"), order.start_of("new")) << "who had a turn waits for who had none";
    EXPECT_LE(order.start_of("polite"), order.start_of("greedy"));
}

TEST(FairOrder, SharesAreEqualInWork) {
    FairOrder order;
    double small = 0, large = 0;
    for (int i = 0; i < 10'000; ++i) {
        const bool is_small = order.start_of("small") <= order.start_of("large");
        (is_small ? small : large) += is_small ? 1 : 50;
        order.begin(is_small ? "small" : "large", is_small ? 1 : 50);
    }
    EXPECT_NEAR(small / large, 1, 0.02);
}

TEST(FairOrder, IdleClientsCollectNoClaim) {
    FairOrder order;
    order.begin("idle", 1);
    for (int i = 0; i < 1000; ++i) order.begin("busy", 1);
    int in_a_row = 0;
    while (order.start_of("idle") < order.start_of("busy")) order.begin("idle", 1), ++in_a_row;
    EXPECT_LE(in_a_row, 2);
}

/// 20 jobs of one client wait when the only job of another one is sent. It does not wait for them.
TEST(ServedFairness, OneJobPassesTheManyOfAnotherClient) {
    const TemporaryDirectory folder;
    write_secret(folder.file("tokens"), "greedy 0123456789abcdef\npolite fedcba9876543210\n");
    Gate gate;
    const Served served([&](service::ServerOptions& options) {
        options.token_file = folder.file("tokens");
        options.engine = gated_engines(gate);
        options.engine_widths = {1, 1, 0};
    });
    const auto client = [&](const std::string& token) {
        ClientOptions options;
        options.token = token;
        return connect(served.address(), options);
    };
    const std::vector<Box3f> boxes = make_boxes("dense", 60'000, 1);
    std::vector<std::unique_ptr<Engine>> engines;  // an engine sends one job at a time
    std::vector<Job> many;
    for (std::size_t i = 0; i < 20; ++i) {
        engines.push_back(client("0123456789abcdef"));
        many.push_back(engines.back()->submit(boxes));
    }
    const auto polite = client("fedcba9876543210");
    ASSERT_TRUE(gate.wait_for(1));
    ASSERT_TRUE(comes_true([&] { return served.load().jobs == 20; }, std::chrono::minutes(1)));
    Job one = polite->submit(boxes);
    ASSERT_TRUE(comes_true([&] { return served.load().jobs == 21; }, std::chrono::minutes(1)));
    std::this_thread::sleep_for(std::chrono::milliseconds(300));  // the uploads end
    gate.open();
    one.wait();
    const auto done = std::ranges::count_if(many, [](const Job& job) { return job.state() == JobState::done; });
    EXPECT_LE(done, 10) << "first come, first served would be 20";
    for (Job& job : many) job.wait();
}

}  // namespace
}  // namespace octopair::test
