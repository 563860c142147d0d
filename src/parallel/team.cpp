#include "parallel/team.hpp"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>

namespace octopair {

struct Team::Arena {
    oneapi::tbb::task_arena arena;
};

namespace {

unsigned thread_count(unsigned asked) { return asked > 0 ? asked : std::max(1u, std::thread::hardware_concurrency()); }

/// Lets oneTBB have as many threads as the largest team; it would otherwise stop at the number of cores, and say so on
/// standard error.
void allow_threads(unsigned threads) {
    using oneapi::tbb::global_control;
    static std::mutex mutex;
    static std::unique_ptr<global_control> allowed;
    const std::lock_guard lock(mutex);
    const auto limit = global_control::max_allowed_parallelism;
    if (threads <= global_control::active_value(limit)) return;
    allowed = nullptr;  // of several limits the lowest would count
    allowed = std::make_unique<global_control>(limit, threads);
}

}  // namespace

Team::Team(unsigned threads) : threads_(thread_count(threads)) {
    if (threads_ > 1) allow_threads(threads_);
    if (threads_ > 1) arena_ = std::make_unique<Arena>(Arena{oneapi::tbb::task_arena(int(threads_))});
}

Team::~Team() = default;

void Team::for_each(std::size_t count, const std::function<void(std::size_t, unsigned)>& body) {
    if (threads_ == 1 || count <= 1) {
        for (std::size_t i = 0; i < count; ++i) body(i, 0);
        return;
    }
    // Indices are handed out in order by one counter, so that early ones, which a consumer may wait for, finish first.
    std::atomic<std::size_t> next = 0;
    const auto work = [&](unsigned worker) {
        try {
            for (std::size_t i = next++; i < count; i = next++) body(i, worker);
        } catch (...) {
            next = count;
            throw;
        }
    };
    const unsigned workers = unsigned(std::min<std::size_t>(threads_, count));
    arena_->arena.execute([&] { oneapi::tbb::parallel_for(0u, workers, work, oneapi::tbb::simple_partitioner()); });
}

void Team::with_helpers(const std::function<void()>& lead, const std::function<void()>& help) {
    if (threads_ == 1) return lead();
    arena_->arena.execute([&] {
        oneapi::tbb::task_group group;
        for (unsigned i = 1; i < threads_; ++i) group.run(help);
        std::exception_ptr failed;
        try {
            lead();
        } catch (...) {
            failed = std::current_exception();
        }
        group.wait();
        if (failed) std::rethrow_exception(failed);
    });
}

void Team::sort(std::span<SortItem> items) {
    constexpr std::size_t worth_sharing = 1 << 15;
    if (threads_ == 1 || items.size() < worth_sharing) return std::sort(items.begin(), items.end());
    arena_->arena.execute([&] { oneapi::tbb::parallel_sort(items.begin(), items.end()); });
}

}  // namespace octopair
