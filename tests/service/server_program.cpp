#include "service/server_program.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <utility>

namespace octopair::test {

ServerProgram::ServerProgram(Setting setting) : setting_(std::move(setting)) { start(); }

ServerProgram::~ServerProgram() {
    if (id_ == 0) return;
    signal(SIGKILL);
    (void)wait();
}

void ServerProgram::start() {
    const std::string line = setting_.before + " exec env " + setting_.environment + " '" OCTOPAIR_PROGRAM "' serve " +
                             setting_.arguments + " --listen '" +
                             (setting_.listen.empty() ? address() : setting_.listen) + "' >>'" + folder_.file("log") +
                             "' 2>&1";
    std::string shell = "sh", option = "-c", command = line;
    char* const words[] = {shell.data(), option.data(), command.data(), nullptr};
    if (::posix_spawn(&id_, "/bin/sh", nullptr, nullptr, words, environ) != 0)
        throw std::runtime_error("cannot start a process");
}

bool ServerProgram::lives() {
    if (id_ == 0) return false;
    siginfo_t ended{};
    return ::waitid(P_PID, id_t(id_), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 && ended.si_pid == 0;
}

void ServerProgram::signal(int number) const {
    if (id_ > 0) (void)::kill(id_, number);
}

int ServerProgram::wait() {
    int status = 0;
    while (::waitpid(id_, &status, 0) < 0 && errno == EINTR) {
    }
    id_ = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

void ServerProgram::kill_and_restart() {
    signal(SIGKILL);
    (void)wait();
    start();
}

std::uint64_t ServerProgram::memory() const {
    std::uint64_t mapped = 0, resident = 0;
    std::ifstream("/proc/" + std::to_string(id_) + "/statm") >> mapped >> resident;
    return resident * std::uint64_t(::sysconf(_SC_PAGESIZE));
}

void ServerProgram::limit_memory(std::uint64_t more) const {
    std::uint64_t mapped = 0;
    std::ifstream("/proc/" + std::to_string(id_) + "/statm") >> mapped;
    const rlim_t most = mapped * std::uint64_t(::sysconf(_SC_PAGESIZE)) + more;
    const rlimit limit{most, most};
    EXPECT_EQ(::prlimit(id_, RLIMIT_AS, &limit, nullptr), 0);
}

std::size_t ServerProgram::descriptors() const {
    std::error_code error;
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/" + std::to_string(id_) + "/fd", error)) {
        (void)entry;
        ++count;
    }
    return count;
}

}  // namespace octopair::test
