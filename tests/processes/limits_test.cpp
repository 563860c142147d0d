// Tests limits on descriptors, memory and file sizes: typed errors, no signals, and an engine that works afterwards.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "processes/asked.hpp"
#include "processes/leftovers.hpp"
#include "support/at_allocation.hpp"
#include "support/errors.hpp"
#include "support/foretold.hpp"
#include "support/scale.hpp"

namespace octopair::test {
namespace {

/// Lowers a limit of this process and its children until destruction.
class Lowered {
public:
    Lowered(decltype(RLIMIT_AS) resource, rlim_t to) : resource_(resource) {
        (void)::getrlimit(resource_, &before_);
        const rlimit lower{to, before_.rlim_max};
        EXPECT_EQ(::setrlimit(resource_, &lower), 0);
    }
    ~Lowered() { (void)::setrlimit(resource_, &before_); }
    Lowered(const Lowered&) = delete;
    Lowered& operator=(const Lowered&) = delete;

private:
    decltype(RLIMIT_AS) resource_;
    rlimit before_{};
};

class WorkerLimits : public Processes {
protected:
    enum class End { right, refused };
    /// Expects the right answer, or an Error with resource_limit or engine_failed. Returns which of the two happened.
    End right_or_refused(Engine& engine, const Scene& scene, const Asked& asked) {
        const Answer expected = ask(*local_, scene, asked);
        try {
            EXPECT_EQ(ask(engine, scene, asked), expected);
            return End::right;
        } catch (const Error& error) {
            EXPECT_TRUE(error.code() == ErrorCode::resource_limit || error.code() == ErrorCode::engine_failed)
                << int(error.code()) << error.what();
            EXPECT_GT(std::string(error.what()).size(), 10u);
            return End::refused;
        }
    }

    const std::unique_ptr<Engine> local_ = make_local_engine(1);
    const Scene scene_{"clustered", 14'000, 1};
    const Scene crowd_{"coincident", 5'000, 1};  // 100 MB of pairs
};

rlim_t used_descriptors() {
    const int lowest = ::dup(0);
    ::close(lowest);
    return rlim_t(lowest);
}

TEST_F(WorkerLimits, OfDescriptorsWhileItIsMade) {
    if (sanitized) GTEST_SKIP() << "the sanitizer opens descriptors to check types";
    unsigned made = 0, refused = 0;
    const rlim_t used = used_descriptors();
    for (rlim_t more = 0; more < 24; ++more) {
        const Lowered lowered(RLIMIT_NOFILE, used + more);
        try {
            const auto engine = make_process_engine(2);
            ++made;
            if (right_or_refused(*engine, scene_, {}) == End::refused) ++refused;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::resource_limit) << error.what();
            ++refused;
        }
    }
    EXPECT_GT(made, 2u);
    EXPECT_GT(refused, 2u);
}

TEST_F(WorkerLimits, OfDescriptorsLater) {
    if (sanitized) GTEST_SKIP() << "the sanitizer opens descriptors to check types";
    const auto engine = make_process_engine(3);
    expect_right(*engine, scene_, {});
    for (rlim_t more = 0; more < 12; ++more) {
        for (const pid_t worker : children_of(::getpid())) (void)::kill(worker, SIGKILL);
        {
            const Lowered lowered(RLIMIT_NOFILE, used_descriptors() - rlim_t(6) + more);
            (void)right_or_refused(*engine, scene_, {.how = How::stream});
        }
        expect_right(*engine, scene_, {.how = How::stream});
    }
}

TEST_F(WorkerLimits, OfEachAllocation) {
    const Scene small{"dense", 300, 1};
    for (const How how : {How::list, How::stream}) {
        const auto engine = make_process_engine(2);
        const std::uint64_t failures =
            fail_every_allocation([] { return 0; }, [&](int) { (void)ask(*engine, small, {.how = how}); },
                                  [&](int, bool failed) {
                                      if (failed) expect_right(*engine, small, {.how = how});
                                  });
        EXPECT_GT(failures, 5u);
    }
}

TEST_F(WorkerLimits, OfFilesWhileItIsMade) {
    for (const rlim_t bytes : {rlim_t(0), rlim_t(4096), rlim_t(1) << 20, rlim_t(1) << 30}) {
        const Lowered lowered(RLIMIT_FSIZE, bytes);
        try {
            const auto engine = make_process_engine(2);
            (void)right_or_refused(*engine, scene_, {});
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::resource_limit) << error.what();
        }
    }
}

TEST_F(WorkerLimits, OfFilesThatPairsDoNotFitInto) {
    for (const rlim_t bytes : {rlim_t(1) << 14, rlim_t(1) << 20, rlim_t(16) << 20, rlim_t(64) << 20}) {
        const auto engine = make_process_engine(2);
        const Lowered lowered(RLIMIT_FSIZE, bytes);
        for (const Order order : {Order::octal, Order::ascending}) {
            SCOPED_TRACE(std::to_string(bytes) + ", order " + std::to_string(int(order)));
            (void)error_of(ErrorCode::resource_limit,
                           [&] { (void)ask(*engine, crowd_, {.how = How::list, .order = order}); });
            if (bytes >= rlim_t(16) << 20) expect_right(*engine, scene_, {.how = How::list, .order = order});
        }
        if (bytes >= rlim_t(16) << 20) expect_right(*engine, crowd_, {.how = How::count});
        EXPECT_EQ(worker_faults(*engine).ended + worker_faults(*engine).stopped, 0u);
    }
}

/// The pairs are counted before they fill their memory. A file for pairs has at most 900 MB here.
TEST_F(WorkerLimits, OfAListWhoseNumberIsToldEarly) {
    const std::vector<Box3f> boxes(16'000, Box3f{{0, 0, 0}, {1, 1, 1}});  // 127,992,000 pairs, 1.02 GB
    const auto engine = make_process_engine(2);
    const Lowered lowered(RLIMIT_FSIZE, 900'000'000);
    for (const Order order : {Order::octal, Order::ascending}) {
        PairList list;
        const std::string message = error_of(ErrorCode::resource_limit, [&] {
            engine->find_pairs(Objects{boxes, {}}, list, {.order = order});
        });
        EXPECT_TRUE(foretells(message,
                              "127,992,000 pairs need 1.02 GB of memory, 900 MB are free; use count_pairs, "
                              "limit or stream_pairs"))
            << message;
        EXPECT_EQ(list.size(), 0u);
        const std::vector<Box3f> fewer(8'500, boxes[0]);  // 289 MB, doubtful at first
        engine->find_pairs(Objects{fewer, {}}, list, {.order = order});
        EXPECT_EQ(list.size(), 36'120'750u);
        list = PairList();
    }
    EXPECT_EQ(worker_faults(*engine).ended + worker_faults(*engine).stopped, 0u);
}

TEST_F(WorkerLimits, OfTheRoomOfAStream) {
    const std::vector<Box3f> boxes(2000, Box3f{{0, 0, 0}, {1, 1, 1}});  // 1,999,000 pairs
    const auto engine = make_process_engine(2);
    for (const Order order : {Order::octal, Order::ascending}) {
        std::uint64_t delivered = 0;
        const PairSink sink = [&](std::span<const Pair> pairs) { delivered += pairs.size(); };
        for (const std::uint64_t most : {100'000u, 400'000u, 1'998'999u}) {
            const Options options{.order = order, .buffer_bytes = 1 << 20};
            const std::string message = error_of(ErrorCode::resource_limit, [&] {
                engine->stream_at_most(most, Objects{boxes, {}}, sink, options);
            });
            EXPECT_TRUE(has_text(message, "1,999,000 pairs; at most "));
        }
        EXPECT_LE(delivered, order == Order::ascending ? 0u : 2'498'999u);
        delivered = 0;
        engine->stream_at_most(1'999'000, Objects{boxes, {}}, sink, {.order = order});
        EXPECT_EQ(delivered, 1'999'000u);
    }
}

rlim_t mapped_bytes() {
    std::uint64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    return rlim_t(pages) * rlim_t(::sysconf(_SC_PAGESIZE));
}

TEST_F(WorkerLimits, OfAddressSpace) {
    if (sanitized) GTEST_SKIP() << "sanitizers map terabytes";
    unsigned made = 0, refused = 0;
    for (const unsigned shift : {20u, 26u, 28u, 30u, 31u, 32u, 33u, 34u, 36u}) {
        const Lowered lowered(RLIMIT_AS, mapped_bytes() + (rlim_t(1) << shift));
        try {
            const auto engine = make_process_engine(2);
            ++made;
            if (right_or_refused(*engine, scene_, {.order = Order::ascending}) == End::refused) ++refused;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::resource_limit) << error.what();
            ++refused;
        }
    }
    EXPECT_GT(made, 1u);
    EXPECT_GT(refused, 1u);
}

/// The memory for pairs is mapped, so that a list in this memory needs no more addresses.
TEST_F(WorkerLimits, OfAddressSpaceWithMappedMemory) {
    if (sanitized) GTEST_SKIP() << "sanitizers map terabytes";
    const std::vector<Box3f> boxes(12'000, Box3f{{0, 0, 0}, {1, 1, 1}});  // 576 MB of pairs
    const auto engine = make_process_engine(2);
    PairList list;
    engine->find_pairs(Objects{std::span(boxes).first(100), {}}, list);
    list = PairList();
    const Lowered lowered(RLIMIT_AS, mapped_bytes() + (rlim_t(50) << 20));
    for (const Order order : {Order::octal, Order::ascending}) {
        engine->find_pairs(Objects{boxes, {}}, list, {.order = order});
        EXPECT_EQ(list.size(), 71'994'000u);
        list = PairList();
    }
}

/// How a child ended that may start few processes and threads.
enum class FewProcesses : std::uint8_t { right, refused, wrong_error, not_tested };

/// Gives up the superuser's rights first, because the superuser has no such limit.
FewProcesses call_with_few_processes(rlim_t most) {
    if (::getuid() == 0 && ::setuid(65534) != 0) return FewProcesses::not_tested;
    const rlimit few{most, most};
    if (::access(OCTOPAIR_TRUE_WORKER, X_OK) != 0 || ::setrlimit(RLIMIT_NPROC, &few) != 0)
        return FewProcesses::not_tested;
    try {
        const auto engine = make_process_engine(2);
        (void)engine->count_pairs(Objects{std::span<const Box3f>()});
        return FewProcesses::right;
    } catch (const Error& error) {
        std::fprintf(stderr, "%llu: %s\n", static_cast<unsigned long long>(most), error.what());
        return error.code() == ErrorCode::resource_limit ? FewProcesses::refused : FewProcesses::wrong_error;
    }
}

/// The worker program, too, starts a thread.
TEST_F(WorkerLimits, OfProcesses) {
    if (sanitized) GTEST_SKIP() << "sanitizers start threads of their own";
    for (rlim_t most = 1; most <= 8; ++most) {
        const pid_t child = ::fork();
        ASSERT_GE(child, 0);
        if (child == 0) ::_exit(int(call_with_few_processes(most)));
        int status = -1;
        ASSERT_EQ(::waitpid(child, &status, 0), child);
        ASSERT_TRUE(WIFEXITED(status));
        const auto end = FewProcesses(WEXITSTATUS(status));
        if (end == FewProcesses::not_tested) GTEST_SKIP() << "this user cannot be limited";
        EXPECT_NE(int(end), int(FewProcesses::wrong_error)) << most;
        if (most == 1) {
            EXPECT_EQ(int(end), int(FewProcesses::refused));
        }
    }
}

}  // namespace
}  // namespace octopair::test
