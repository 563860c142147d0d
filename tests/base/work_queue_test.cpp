// Tests WorkQueue: order, choice of items, end, and the removal of obsolete items.
#include "base/work_queue.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

namespace octopair::test {
namespace {

constexpr std::chrono::milliseconds retry(1);

TEST(WorkQueue, RunsItemsInTheirOrder) {
    WorkQueue<int> queue;
    for (int i = 0; i < 100; ++i) queue.add(i);
    queue.finish();
    std::vector<int> done;
    queue.run([&](int item) { done.push_back(item); });
    ASSERT_EQ(done.size(), 100u);
    for (int i = 0; i < 100; ++i) EXPECT_EQ(done[std::size_t(i)], i);
}

TEST(WorkQueue, EachItemIsWorkedOnByOneThread) {
    constexpr int items = 10'000;
    WorkQueue<int> queue;
    std::vector<std::atomic<int>> times(items);
    std::vector<std::jthread> threads;
    for (int i = 0; i < 4; ++i) {
        threads.emplace_back([&] { queue.run([&](int item) { ++times[std::size_t(item)]; }); });
    }
    for (int i = 0; i < items; ++i) queue.add(i);
    queue.wait_until_idle();
    queue.finish();
    threads.clear();
    for (const auto& count : times) EXPECT_EQ(count, 1);
}

TEST(WorkQueue, AClosedQueueKeepsWhatWaits) {
    WorkQueue<int> queue;
    for (int i = 0; i < 3; ++i) queue.add(i);
    std::vector<int> done;
    queue.run([&](int item) {
        done.push_back(item);
        if (item == 1) queue.close();
    });
    EXPECT_EQ(done, (std::vector{0, 1}));
    EXPECT_EQ(queue.waiting(), 1u);
    EXPECT_EQ(queue.items(), (std::list{2}));
}

TEST(WorkQueue, AnItemInWorkIsStillAnItemOfTheQueue) {
    WorkQueue<int> queue;
    queue.add(1);
    queue.add(2);
    queue.finish();
    queue.run([&](int item) {
        EXPECT_EQ(queue.items().front(), item);
        EXPECT_EQ(queue.items().size(), item == 1 ? 2u : 1u);
    });
    EXPECT_TRUE(queue.items().empty());
}

TEST(WorkQueue, AThreadThatIsIdleRunsItsTask) {
    WorkQueue<int> queue;
    std::vector<std::string> done;
    queue.add(1);
    const auto first = [](WorkQueue<int>::Items& waiting) { return waiting.begin(); };
    const auto work = [&](int item) { done.push_back("item " + std::to_string(item)); };
    int times = 0;
    const auto task = [&] {
        done.push_back("idle");
        if (++times == 1) {
            queue.add(2);
        } else {
            queue.finish();
        }
    };
    queue.run(first, std::chrono::hours(1), work, WorkQueue<int>::Idle{std::chrono::milliseconds(1), task});
    EXPECT_EQ(done, (std::vector<std::string>{"item 1", "idle", "item 2", "idle"}));
}

TEST(WorkQueue, AnItemThatIsNotChosenWaitsUntilItIs) {
    WorkQueue<int> queue;
    std::atomic<bool> odd_ones_too = false;
    const auto choose = [&](WorkQueue<int>::Items& waiting) {
        return std::ranges::find_if(waiting, [&](int item) { return odd_ones_too || item % 2 == 0; });
    };
    std::vector<int> done;
    for (const int item : {1, 2, 3, 4}) queue.add(item);
    std::jthread thread([&] { queue.run(choose, retry, [&](int item) { done.push_back(item); }); });
    while (queue.waiting() > 2) std::this_thread::yield();
    EXPECT_EQ(queue.waiting_before([](int item) { return item == 3; }), 1u);
    EXPECT_EQ(queue.waiting_before([](int item) { return item == 2; }), 0u);
    odd_ones_too = true;  // no notification: the thread calls `choose` again after `retry`
    queue.wait_until_idle();
    queue.finish();
    thread.join();
    EXPECT_EQ(done, (std::vector{2, 4, 1, 3}));
}

TEST(WorkQueue, ObsoleteItemsAreRemovedBeforeTheQueueDoubles) {
    WorkQueue<int> queue;
    const auto is_odd = [](int item) { return item % 2 == 1; };
    std::size_t largest = 0;
    for (int i = 0; i < 1000; ++i) {
        queue.add(1, is_odd);
        largest = std::max(largest, queue.waiting());
    }
    EXPECT_LE(largest, 64u);
    for (int i = 0; i < 1000; ++i) queue.add(2, is_odd);
    EXPECT_GE(queue.waiting(), 1000u);
}

/// An item whose destructor adds another item.
struct Chain {
    WorkQueue<std::shared_ptr<Chain>>* queue;
    int left;
    ~Chain() {
        if (left > 0) queue->add(std::make_shared<Chain>(queue, left - 1));
        if (left == 0) queue->finish();
    }
};

TEST(WorkQueue, AnItemIsDestroyedWithTheQueueUnlocked) {
    WorkQueue<std::shared_ptr<Chain>> queue;
    queue.add(std::make_shared<Chain>(&queue, 3));
    int done = 0;
    queue.run([&](const std::shared_ptr<Chain>&) { ++done; });
    EXPECT_EQ(done, 4);
}

}  // namespace
}  // namespace octopair::test
