// EventCount: lets processes wait for a change of a counter in shared memory. Built on Linux futexes.
#pragma once

#include <linux/futex.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <climits>
#include <cstdint>

namespace octopair {

static_assert(std::atomic<std::uint32_t>::is_always_lock_free && std::atomic<std::uint64_t>::is_always_lock_free);

/// Sleeps while `word` is `value`. Returns after futex_wake_all(), after `most`, or spuriously.
inline void futex_wait(std::atomic<std::uint32_t>& word, std::uint32_t value, std::chrono::nanoseconds most) {
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(most);
    const timespec timeout{time_t(seconds.count()), long((most - seconds).count())};
    (void)::syscall(SYS_futex, reinterpret_cast<std::uint32_t*>(&word), FUTEX_WAIT, value, &timeout, nullptr, 0);
}

inline void futex_wake_all(std::atomic<std::uint32_t>& word) {
    (void)::syscall(SYS_futex, reinterpret_cast<std::uint32_t*>(&word), FUTEX_WAKE, INT_MAX, nullptr, nullptr, 0);
}

/// Counter of events. raise() makes a system call only while some process waits.
struct EventCount {
    std::atomic<std::uint32_t> count = 0;
    std::atomic<std::uint32_t> waiting = 0;

    void raise() {
        count.fetch_add(1);
        if (waiting.load() != 0) futex_wake_all(count);
    }
    /// Waits until `count` differs from `seen`: polls `spins` times, then sleeps at most `most`. May return spuriously.
    void wait(std::uint32_t seen, std::chrono::nanoseconds most, unsigned spins) {
        for (unsigned i = 0; i < spins; ++i) {
            if (count.load(std::memory_order_acquire) != seen) return;
#if defined(__x86_64__) || defined(__i386__)
            __builtin_ia32_pause();
#endif
        }
        waiting.fetch_add(1);
        if (count.load() == seen) futex_wait(count, seen, most);
        waiting.fetch_sub(1);
    }
};

}  // namespace octopair
