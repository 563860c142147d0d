// Tests worker programs that are not workers: typed errors name the program, and no resources are left behind.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

#include "io/temporary.hpp"
#include "processes/asked.hpp"
#include "processes/leftovers.hpp"
#include "support/compare.hpp"
#include "support/errors.hpp"

namespace octopair::test {
namespace {

class WorkerPrograms : public Processes {
protected:
    std::string make_program(const std::string& name, const std::string& text, mode_t mode) const {
        const std::string path = directory_.file(name);
        write_file(path, text);
        EXPECT_EQ(::chmod(path.c_str(), mode), 0);
        return path;
    }

    /// Expects that the construction or every call fails with an error that names the program.
    void expect_failed(const std::string& program, int calls = 2) {
        try {
            const auto engine = make_process_engine({.workers = 2, .worker_program = program});
            for (int i = 0; i < calls; ++i) {
                expect_error(ErrorCode::engine_failed, program, [&] { (void)ask(*engine, scene_, {}); });
            }
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::engine_failed) << error.what();
            EXPECT_TRUE(has_text(error.what(), program));
        }
    }

    TemporaryDirectory directory_;
    const Scene scene_{"uniform", 10'000, 1};
};

TEST_F(WorkerPrograms, ThatAreNotThere) { expect_failed(directory_.file("nothing")); }
TEST_F(WorkerPrograms, ThatMayNotBeRun) {
    expect_failed(make_program("plain", "#!/bin/sh\nexit 0\n", 0644));
    expect_failed(directory_.path());
}
TEST_F(WorkerPrograms, ThatAreNoPrograms) { expect_failed(make_program("noise", std::string(4096, '\1'), 0755)); }
TEST_F(WorkerPrograms, ThatEndAtOnce) {
    expect_failed("/bin/true");
    expect_failed("/bin/false");
    expect_failed(make_program("signal", "#!/bin/sh\nkill -9 $$\n", 0755));
}
TEST_F(WorkerPrograms, ThatEndSoon) { expect_failed(make_program("soon", "#!/bin/sh\nsleep 0.05\nexit 3\n", 0755)); }
TEST_F(WorkerPrograms, ThatNeverAnswer) {
    expect_failed(make_program("mute", "#!/bin/sh\nexec sleep 1000\n", 0755), 1);
}

TEST_F(WorkerPrograms, ThatCannotBeFound) {
    ::setenv("OCTOPAIR_WORKER", directory_.file("elsewhere").c_str(), 1);
    EXPECT_THROW((void)make_process_engine(1), Error);
    ::setenv("OCTOPAIR_WORKER", OCTOPAIR_TRUE_WORKER, 1);
    EXPECT_NO_THROW((void)make_process_engine(1));
    ::unsetenv("OCTOPAIR_WORKER");
}

TEST_F(WorkerPrograms, ThatAreGoneForAWhile) {
    const std::string program = directory_.file("worker");
    std::filesystem::copy_file(OCTOPAIR_TRUE_WORKER, program);
    const auto engine = make_process_engine({.workers = 2, .worker_program = program});
    const auto expected = ask(*make_local_engine(1), scene_, {});
    EXPECT_EQ(ask(*engine, scene_, {}), expected);
    std::filesystem::rename(program, program + "-away");
    EXPECT_EQ(ask(*engine, scene_, {}), expected);
    for (const pid_t worker : children_of(::getpid())) (void)::kill(worker, SIGKILL);
    for (int i = 0; i < 3; ++i) {
        expect_error(ErrorCode::engine_failed, program, [&] { (void)ask(*engine, scene_, {}); });
    }
    std::filesystem::rename(program + "-away", program);
    EXPECT_EQ(ask(*engine, scene_, {}), expected);
}

TEST_F(WorkerPrograms, AreNotStartedInNumbersBeyondReason) {
    EXPECT_EQ(error_of(ErrorCode::usage, [] { (void)make_process_engine(max_workers + 1); }),
              "workers: 257 is not in the range 0 to 256");
    EXPECT_EQ(ask(*make_process_engine(64), scene_, {}), ask(*make_local_engine(1), scene_, {}));
}

}  // namespace
}  // namespace octopair::test
