// Tests lifetimes. Lists stay valid after later calls of their engine, destroyed box arrays leave no descriptors open,
// and a forked process cannot use its parent's engine.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <vector>

#include "octopair/error.hpp"
#include "processes/leftovers.hpp"
#include "samples/scenes.hpp"

namespace octopair::test {
namespace {

class WorkerLifetimes : public test::Processes {
protected:
    static std::vector<Pair> expected(std::span<const Box3f> boxes) {
        PairList list;
        make_local_engine(1)->find_pairs({boxes}, list);
        return list.to_vector();
    }
};

TEST_F(WorkerLifetimes, ManySmallListsTakeNoDescriptors) {
    const auto engine = make_process_engine(2);
    const auto boxes = samples::make_scene("dense", 300, 1);
    const auto pairs = expected(boxes);
    std::vector<PairList> lists;
    for (int i = 0; i < 300; ++i) engine->find_pairs({boxes}, lists.emplace_back());
    EXPECT_LT(test::Belongings::now().descriptors, 40u);
    for (const PairList& list : lists) ASSERT_EQ(list.to_vector(), pairs);
}

TEST_F(WorkerLifetimes, LargeListsStayAsTheyAre) {
    const auto engine = make_process_engine(2);
    std::vector<PairList> lists(8);
    std::vector<std::vector<Pair>> pairs;
    for (std::size_t i = 0; i < lists.size(); ++i) {
        const auto boxes = samples::make_scene("dense", 10'000, i);
        pairs.push_back(expected(boxes));
        engine->find_pairs({boxes}, lists[i]);
    }
    EXPECT_LT(test::Belongings::now().descriptors, 40u);
    for (std::size_t i = 0; i < lists.size(); ++i) EXPECT_EQ(lists[i].to_vector(), pairs[i]) << i;
}

TEST_F(WorkerLifetimes, BoxesThatAreGoneAreForgotten) {
    const auto engine = make_process_engine(3);
    const std::size_t before = test::Belongings::now().descriptors;
    const auto boxes = samples::make_scene("uniform", 20'000, 1);
    const auto pairs = expected(boxes);
    PairList list;
    for (int i = 0; i < 20; ++i) {
        auto array = engine->allocate_boxes(boxes.size());
        std::copy(boxes.begin(), boxes.end(), array.boxes().begin());
        engine->find_pairs({std::span<const Box3f>(array.boxes())}, list);
        ASSERT_EQ(list.to_vector(), pairs);
    }
    EXPECT_LE(test::Belongings::now().descriptors, before + 4) << "more is open than the arena and the pairs";
}

TEST_F(WorkerLifetimes, AForkedProcessLeavesTheWorkersAlone) {
    auto engine = make_process_engine(2);
    const auto boxes = samples::make_scene("uniform", 20'000, 1);
    PairList list;
    engine->find_pairs({boxes}, list);
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        int status = 1;
        try {
            PairList other;
            engine->find_pairs({boxes}, other);
        } catch (const Error& error) {
            status = error.code() == ErrorCode::usage ? 0 : 2;
        }
        engine = nullptr;
        ::_exit(status);
    }
    int status = -1;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
    engine->find_pairs({boxes}, list);
    EXPECT_EQ(list.to_vector(), expected(boxes));
    EXPECT_EQ(worker_faults(*engine).ended, 0u);
}

}  // namespace
}  // namespace octopair::test
