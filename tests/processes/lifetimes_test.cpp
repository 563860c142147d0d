// Tests lifetimes. Lists stay valid after later calls of their engine, destroyed box arrays leave no descriptors open,
// and a forked process cannot use its parent's engine.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/descriptor.hpp"
#include "octopair/error.hpp"
#include "processes/leftovers.hpp"
#include "samples/random.hpp"
#include "samples/scenes.hpp"
#include "support/calls.hpp"
#include "support/cases.hpp"
#include "support/errors.hpp"

namespace octopair::test {
namespace {

class WorkerLifetimes : public Processes {
protected:
    static std::vector<Pair> expected(std::span<const Box3f> boxes) {
        return listed_pairs(*make_local_engine(1), {boxes});
    }
};

TEST_F(WorkerLifetimes, ManySmallListsTakeNoDescriptors) {
    const auto engine = make_process_engine(2);
    const auto boxes = samples::make_scene("dense", 300, 1);
    const auto pairs = expected(boxes);
    std::vector<PairList> lists;
    for (int i = 0; i < 300; ++i) engine->find_pairs({boxes}, lists.emplace_back());
    EXPECT_LT(Belongings::now().descriptors, 40u);
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
    EXPECT_LT(Belongings::now().descriptors, 40u);
    for (std::size_t i = 0; i < lists.size(); ++i) EXPECT_EQ(lists[i].to_vector(), pairs[i]) << i;
}

TEST_F(WorkerLifetimes, BoxesThatAreGoneAreForgotten) {
    const auto engine = make_process_engine(3);
    const std::size_t before = Belongings::now().descriptors;
    const auto boxes = samples::make_scene("uniform", 20'000, 1);
    const auto pairs = expected(boxes);
    PairList list;
    for (int i = 0; i < 20; ++i) {
        auto array = engine->allocate_boxes(boxes.size());
        std::copy(boxes.begin(), boxes.end(), array.boxes().begin());
        engine->find_pairs({std::span<const Box3f>(array.boxes())}, list);
        ASSERT_EQ(list.to_vector(), pairs);
    }
    EXPECT_LE(Belongings::now().descriptors, before + 4) << "more is open than the arena and the pairs";
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

/// Returns the descriptors of a process, and the file or socket of each.
std::vector<std::pair<int, std::string>> open_files(pid_t process) {
    std::vector<std::pair<int, std::string>> open;
    const std::filesystem::path folder = "/proc/" + std::to_string(process) + "/fd";
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        std::error_code closed;  // the descriptor that lists the folder is closed afterwards
        const std::string file = std::filesystem::read_symlink(entry.path(), closed).string();
        if (!closed) open.emplace_back(std::stoi(entry.path().filename()), file);
    }
    return open;
}

TEST_F(WorkerLifetimes, InheritNoOpenFile) {
    const Descriptor inheritable(::memfd_create("of the application", 0));  // without MFD_CLOEXEC
    ASSERT_GE(inheritable.number(), 0);
    const auto engine = make_process_engine(2);
    const auto boxes = samples::make_scene("uniform", 20'000, 1);
    PairList list;
    engine->find_pairs({boxes}, list);
    const std::vector<pid_t> workers = children_of(::getpid());
    ASSERT_EQ(workers.size(), 2u);
    for (const pid_t worker : workers) {
        std::size_t sockets = 0;
        for (const auto& [number, file] : open_files(worker)) {
            EXPECT_FALSE(has_text(file, "of the application"));
            sockets += file.starts_with("socket:") && number > 2 ? 1 : 0;
        }
        EXPECT_EQ(sockets, 1u);
    }
}

TEST_F(WorkerLifetimes, SharedFilesHaveNoNameAndCannotBeCut) {
    const auto engine = make_process_engine(2);
    PairList list;
    const auto boxes = samples::make_scene("dense", 20'000, 1);
    engine->find_pairs({boxes}, list);
    std::size_t shared = 0;
    for (const auto& [number, file] : open_files(::getpid())) {
        if (!file.starts_with("/memfd:octopair")) continue;
        ++shared;
        EXPECT_NE(::fcntl(number, F_GET_SEALS) & F_SEAL_SHRINK, 0) << file;
        EXPECT_NE(::ftruncate(number, 0), 0) << file;
    }
    EXPECT_GE(shared, 2u);
    EXPECT_TRUE(Belongings::now().named_memory.empty());
}

/// Starts the test application (application.cpp), which starts workers.
pid_t start_application() {
    const pid_t id = ::fork();
    if (id != 0) return id;
    (void)::dup2(::open("/dev/null", O_WRONLY), 1);
    (void)::execl(OCTOPAIR_BAD_APPLICATION, "application", "busy", nullptr);
    ::_exit(127);
}

/// Waits for the children that have ended. Returns whether there are no others.
bool all_ended() {
    while (::waitpid(-1, nullptr, WNOHANG) > 0) {
    }
    return children_of(::getpid()).empty();
}

/// Returns the workers of an application that run their program, which may not be loaded yet. Before, for some microseconds, a child
/// has not run a single instruction; Linux cannot arm the parent-death signal of a process that is stopped then.
std::vector<pid_t> workers_of(pid_t application) {
    std::vector<pid_t> workers;
    for (const ProcessStatus& one : all_processes()) {
        if (one.parent == application && one.name == "octopair-worker") workers.push_back(one.id);
    }
    return workers;
}

/// Workers get signals at random moments of their first 50 ms, and then the application is killed.
TEST_F(WorkerLifetimes, NoWorkerOutlivesItsClient) {
    ASSERT_EQ(::prctl(PR_SET_CHILD_SUBREAPER, 1), 0);  // workers without a parent become children of this process
    samples::RandomStream random(test_seed(1), 1);
    const auto pause = [&] { std::this_thread::sleep_for(std::chrono::microseconds(random.below(25'000))); };
    const std::uint64_t most = case_count(60);
    for (std::uint64_t i = 0; i < most; ++i) {
        const pid_t application = start_application();
        ASSERT_GT(application, 0);
        pause();
        constexpr std::array<int, 4> signals = {SIGSTOP, SIGSTOP, SIGKILL, SIGTERM};
        for (const pid_t worker : workers_of(application)) (void)::kill(worker, signals[random.below(4)]);
        pause();
        for (const pid_t worker : workers_of(application)) (void)::kill(worker, SIGSTOP);
        (void)::kill(application, SIGKILL);
        if (comes_true(all_ended, std::chrono::seconds(10))) continue;
        for (const pid_t left : children_of(::getpid())) {
            ADD_FAILURE() << "process " << left << " is left of application " << i;
            (void)::kill(left, SIGKILL);
        }
    }
    EXPECT_TRUE(comes_true(all_ended, std::chrono::seconds(10)));
    (void)::prctl(PR_SET_CHILD_SUBREAPER, 0);
}

}  // namespace
}  // namespace octopair::test
