// Tests that clients take turns: one with many jobs does not make the others wait for all of them.
#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <thread>

#include "processes/leftovers.hpp"
#include "service/gate.hpp"
#include "service/guarded.hpp"
#include "service/metrics_page.hpp"
#include "service/protocol/errors.hpp"
#include "service/served.hpp"
#include "service/server/jobs/budget.hpp"
#include "service/server/jobs/fair_order.hpp"
#include "service/server/jobs/job_scheduler.hpp"
#include "service/server_program.hpp"
#include "support/kinds.hpp"

namespace octopair::test {
namespace {

/// Expects that `call` throws LimitError with this limit.
void expect_limit(const std::string& name, std::uint64_t allowed, const std::function<void()>& call) {
    try {
        call();
        ADD_FAILURE() << "not refused";
    } catch (const service::LimitError& error) {
        EXPECT_EQ(error.name(), name);
        EXPECT_EQ(error.allowed(), allowed);
    }
}

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

TEST(FairOrder, WorkThatWasUnderestimatedCounts) {
    FairOrder order;
    order.begin("dense", 100);
    order.begin("plain", 100);
    order.add("dense", 250);
    order.add("unknown", 1);
    int plain = 0;
    for (int i = 0; i < 10; ++i) {
        const bool turn = order.start_of("plain") < order.start_of("dense");
        plain += turn ? 1 : 0;
        order.begin(turn ? "plain" : "dense", 100);
    }
    EXPECT_EQ(plain, 6) << "250 more than 100 are 3 turns";
}

TEST(FairOrder, IdleClientsCollectNoClaim) {
    FairOrder order;
    order.begin("idle", 1);
    for (int i = 0; i < 1000; ++i) order.begin("busy", 1);
    int in_a_row = 0;
    while (order.start_of("idle") < order.start_of("busy")) order.begin("idle", 1), ++in_a_row;
    EXPECT_LE(in_a_row, 2);
}

TEST(Budget, AClientHasALimitOfItsOwn) {
    service::Budget budget("bytes", "bytes of it", 100, 60);
    auto greedy = budget.take(50, "greedy");
    expect_limit("bytes_per_client", 60, [&] { (void)budget.take(11, "greedy"); });
    expect_limit("bytes_per_client", 60, [&] { greedy.grow(11); });
    greedy.grow(10);
    auto polite = budget.take(40, "polite");
    expect_limit("bytes", 100, [&] { (void)budget.take(1, "polite"); });
    greedy.shrink(30);
    EXPECT_EQ(budget.taken(), 70u);
    auto server = budget.take(30);  // of no client
    server.give_back();
    auto moved = std::move(greedy);
    moved.give_back();
    greedy = budget.take(60, "greedy");
    expect_limit("bytes_per_client", 60, [&] { budget.check(61); });
    expect_limit("bytes", 100, [&] { budget.check(101); });
}

/// A server with two clients, whose engine waits at a gate.
class ServedFairness : public ::testing::Test {
protected:
    ServedFairness() { write_secret(folder_.file("tokens"), "greedy 0123456789abcdef\npolite fedcba9876543210\n"); }

    Served::Change gated(std::uint64_t memory_bytes = std::uint64_t(8) << 30) {
        return [this, memory_bytes](service::ServerOptions& options) {
            options.token_file = folder_.file("tokens");
            options.engine = gated_engines(gate_);
            options.engine_widths = {1, 1, 0};
            options.limits.memory_bytes = memory_bytes;
        };
    }
    static std::unique_ptr<Engine> client(const Served& served, const std::string& token) {
        ClientOptions options{.token = token};
        return connect(served.address(), options);
    }
    static std::unique_ptr<Engine> polite(const Served& served) { return client(served, "fedcba9876543210"); }
    /// Submits jobs of the greedy client. An engine sends one job at a time, so each has its own.
    void submit_greedy(const Served& served, const std::vector<Box3f>& boxes, std::size_t jobs) {
        for (std::size_t i = 0; i < jobs; ++i) {
            engines_.push_back(client(served, "0123456789abcdef"));
            many_.push_back(engines_.back()->submit(boxes));
        }
    }
    std::ptrdiff_t count(JobState state) const {
        return std::ranges::count_if(many_, [state](const Job& job) { return job.state() == state; });
    }

    TemporaryDirectory folder_;
    Gate gate_;
    std::vector<std::unique_ptr<Engine>> engines_;
    std::vector<Job> many_;
};

/// 20 jobs of one client wait when the only job of another one is sent. It does not wait for them.
TEST_F(ServedFairness, OneJobPassesTheManyOfAnotherClient) {
    const Served served(gated());
    const std::vector<Box3f> boxes = make_boxes("dense", 60'000, 1);
    submit_greedy(served, boxes, 20);
    const auto engine = polite(served);
    ASSERT_TRUE(gate_.wait_for(1));
    ASSERT_TRUE(comes_true([&] { return served.load().jobs == 20; }, std::chrono::minutes(1)));
    Job one = engine->submit(boxes);
    ASSERT_TRUE(comes_true([&] { return served.load().jobs == 21; }, std::chrono::minutes(1)));
    std::this_thread::sleep_for(std::chrono::milliseconds(300));  // the uploads end
    gate_.open();
    one.wait();
    EXPECT_LE(count(JobState::done), 10) << "first come, first served would be 20";
    for (Job& job : many_) job.wait();
}

/// Few objects can have so many pairs that a job takes long. One client cannot hold all engines of small jobs with them.
TEST_F(ServedFairness, OneClientLeavesAnEngineOfSmallJobs) {
    const Served served([this](service::ServerOptions& options) {
        gated()(options);
        options.engine = gated_engines(gate_, 4'000);
        options.engine_widths = {1, 3, 0};
    });
    submit_greedy(served, make_boxes("dense", 5'000, 1), 5);
    ASSERT_TRUE(gate_.wait_for(2));
    ASSERT_TRUE(comes_true([&] { return served.load().jobs == 5; }, std::chrono::minutes(1)));
    const auto engine = polite(served);
    Job one = engine->submit(make_boxes("dense", 3'000, 1));
    EXPECT_TRUE(comes_true([&] { return one.state() == JobState::done; }, std::chrono::minutes(1)));
    gate_.open();
    one.wait();
    for (Job& job : many_) job.wait();
    EXPECT_EQ(count(JobState::done), 5);
}

/// The spare engine is one more than the workers, so a client whom nobody disturbs has as many as there are workers.
TEST_F(ServedFairness, OneClientAloneHasAsManyEnginesAsWorkers) {
    const ServerProgram server({.arguments = "--engine processes --workers 2 --metrics localhost:0 --tokens '" +
                                             folder_.file("tokens") + "'"});
    const std::vector<Box3f> crowd(10'000, Box3f{{0, 0, 0}, {1, 1, 1}});  // 50 million pairs
    const auto count_again_and_again = [&](const std::stop_token& stop) {
        const auto engine = connect(server.address(), {.token = "0123456789abcdef"});
        while (!stop.stop_requested()) (void)engine->count_pairs({crowd});
    };
    (void)connect(server.address(),
                  {.token = "0123456789abcdef"});  // waits until the server listens and has written its log
    const std::jthread first(count_again_and_again), second(count_again_and_again);
    const std::string both_run = "\noctopair_jobs{state=\"running\"} 2\n";
    EXPECT_TRUE(comes_true([&] { return metrics_page(server.log()).find(both_run) != std::string::npos; },
                           std::chrono::minutes(1)));
}

/// Engines keep the memory of their largest job for later ones. A server gives it back when it is idle.
TEST_F(ServedFairness, IdleEnginesAreMadeAnew) {
    std::atomic<int> made = 0;
    const Served served([&](service::ServerOptions& options) {
        options.engine = [&](unsigned width) {
            ++made;
            return make_local_engine(width);
        };
        options.engine_widths = {1, 1, 1};
        options.renewable_engines = true;
    });
    EXPECT_EQ(made, 3);
    const auto engine = connect(served.address());
    PairList pairs;
    std::vector<Box3f> boxes;
    for (const std::size_t objects : {30'000u, 5'000u, 100u}) {
        boxes = make_boxes("dense", objects, 1);
        engine->find_pairs({boxes}, pairs);
    }
    ASSERT_TRUE(comes_true([&] { return made >= 6; }, std::chrono::minutes(1)));
    const auto before = pairs.size();
    engine->find_pairs({boxes}, pairs);
    EXPECT_EQ(pairs.size(), before);
}

TEST(KeptEngine, IsNotMadeAnewWhileItIsInUse) {
    service::KeptEngine kept([](unsigned width) { return make_local_engine(width); }, 1);
    std::weak_ptr<Engine> first;
    {
        const auto used = kept.use();
        first = used;
        kept.renew();
        EXPECT_EQ(kept.use(), used);
    }
    kept.renew();
    EXPECT_TRUE(first.expired());
    EXPECT_NE(kept.use(), nullptr);
}

/// Jobs of one client do not take the memory that a job of another client needs.
TEST_F(ServedFairness, OneClientCannotTakeAllMemory) {
    const Served served(gated(100'000'000));
    const std::vector<Box3f> boxes = make_boxes("uniform", 100'000, 1);  // 10.4 MB a job
    submit_greedy(served, boxes, 8);
    ASSERT_TRUE(comes_true([&] { return count(JobState::failed) == 4; }, std::chrono::minutes(1)))
        << "half has room for 4 jobs";
    EXPECT_GT(served.load().memory_bytes, 41'000'000u);
    const auto engine = polite(served);
    Job one = engine->submit(boxes);
    EXPECT_LE(served.load().memory_bytes, 61'000'000u);
    gate_.open();
    one.wait();
    EXPECT_NO_THROW((void)one.summary());
    for (Job& job : many_) job.wait();
    EXPECT_EQ(count(JobState::failed), 4);
}

}  // namespace
}  // namespace octopair::test
