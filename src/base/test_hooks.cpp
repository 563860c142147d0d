#include "base/test_hooks.hpp"

#ifdef OCTOPAIR_TEST_HOOKS

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <new>
#include <string>
#include <system_error>

namespace octopair {

namespace {

[[noreturn]] void throw_failed(const char* path) {
    throw std::system_error(errno, std::generic_category(), std::string("cannot use test hooks in ") + path);
}

/// Returns the state in the file at `path`. Creates the file unless it has the right size.
/// Requires: one process has created the file before others open it.
TestHooks* hooks_in_file(const char* path) {
    const int file = ::open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (file < 0) throw_failed(path);
    const bool fresh = ::lseek(file, 0, SEEK_END) != off_t(sizeof(TestHooks));
    if (fresh && ::ftruncate(file, sizeof(TestHooks)) != 0) throw_failed(path);
    void* const memory = ::mmap(nullptr, sizeof(TestHooks), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    if (memory == MAP_FAILED) throw_failed(path);
    ::close(file);
    return fresh ? new (memory) TestHooks : static_cast<TestHooks*>(memory);
}

TestHooks* find_hooks() {
    static TestHooks own;
    const char* const path = std::getenv("OCTOPAIR_TEST_HOOKS_FILE");
    return path == nullptr ? &own : hooks_in_file(path);
}

}  // namespace

TestHooks& test_hooks() {
    static TestHooks* const hooks = find_hooks();
    return *hooks;
}

const Tuning& tuning() { return test_hooks().tuning; }

void count_path(Path path) { test_hooks().paths[std::size_t(path)].fetch_add(1, std::memory_order_relaxed); }

bool planted(Fault fault) { return test_hooks().fault == fault; }

bool is_stop_planned() { return test_hooks().polls_before_stop.fetch_sub(1, std::memory_order_relaxed) <= 0; }

}  // namespace octopair

#endif
