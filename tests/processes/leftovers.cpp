#include "processes/leftovers.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

namespace octopair::test {

namespace {

namespace fs = std::filesystem;

bool is_number(const std::string& text) {
    return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace

std::vector<ProcessStatus> all_processes() {
    std::vector<ProcessStatus> all;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator("/proc", error)) {
        if (!is_number(entry.path().filename())) continue;
        std::string text;
        std::getline(std::ifstream(entry.path() / "stat"), text);
        const std::size_t open = text.find('('), close = text.rfind(')');
        if (open == std::string::npos || close == std::string::npos || close + 4 > text.size()) continue;
        ProcessStatus status;
        status.id = std::stoi(text);
        status.name = text.substr(open + 1, close - open - 1);
        status.state = text[close + 2];
        status.parent = std::stoi(text.substr(close + 4));
        all.push_back(std::move(status));
    }
    return all;
}

std::vector<pid_t> children_of(pid_t parent) {
    std::vector<pid_t> children;
    for (const ProcessStatus& process : all_processes()) {
        if (process.parent == parent) children.push_back(process.id);
    }
    return children;
}

bool process_lives(pid_t id) {
    const auto all = all_processes();
    return std::any_of(all.begin(), all.end(),
                       [&](const ProcessStatus& process) { return process.id == id && process.state != 'Z'; });
}

bool comes_true(const std::function<bool()>& condition, std::chrono::milliseconds most) {
    const auto last = std::chrono::steady_clock::now() + most;
    while (!condition()) {
        if (std::chrono::steady_clock::now() > last) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(3));
    }
    return true;
}

Belongings Belongings::now() {
    Belongings found;
    found.children = children_of(::getpid());
    std::error_code error;
    for (const auto& entry : fs::directory_iterator("/proc/self/fd", error)) {
        (void)entry;
        ++found.descriptors;
    }
    for (const auto& entry : fs::directory_iterator("/dev/shm", error)) {
        const std::string name = entry.path().filename();
        if (name.find("octopair") != std::string::npos) found.named_memory.insert(name);
    }
    return found;
}

void Processes::SetUp() { before_ = Belongings::now(); }

void Processes::TearDown() {
    const Belongings after = Belongings::now();
    EXPECT_EQ(after.children, before_.children) << "processes are left";
    EXPECT_EQ(after.descriptors, before_.descriptors) << "descriptors are left open";
    EXPECT_EQ(after.named_memory, before_.named_memory) << "shared memory is left";
}

std::unique_ptr<Engine> make_faulty_engine(unsigned workers) {
    return make_process_engine({.workers = workers, .worker_program = OCTOPAIR_FAULTY_WORKER});
}

std::uint64_t test_seed(std::uint64_t usual) {
    const char* const asked = std::getenv("OCTOPAIR_TEST_SEED");
    return asked != nullptr ? std::strtoull(asked, nullptr, 10) : usual;
}

}  // namespace octopair::test
