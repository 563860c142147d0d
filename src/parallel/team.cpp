#include "parallel/team.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "base/control_group.hpp"
#include "octopair/error.hpp"
#include "octopair/limits.hpp"
#include "parallel/tbb_threads.hpp"

namespace octopair {

unsigned thread_count(unsigned requested) {
    if (requested > max_threads) {
        throw Error(ErrorCode::usage, "threads: " + std::to_string(requested) + " is not in the range 0 to " +
                                          std::to_string(max_threads));
    }
    return requested > 0 ? requested : std::min(available_cores(), max_threads);
}

namespace {

/// Keeps TbbThreads that no team uses any more, by their number of threads, for later teams. oneTBB 2021.8 never frees about 7 KB of each
/// arena that threads have entered. So without reuse, a program that makes an engine for each call would need more and more memory.
///
/// Never destroyed: oneTBB may have ended before the destructors of static objects run.
class IdleThreads {
public:
    std::unique_ptr<TbbThreads> take(unsigned threads) {
        const std::lock_guard lock(mutex_);
        auto& idle = idle_[threads];
        if (idle.empty()) return std::make_unique<TbbThreads>(threads);
        auto taken = std::move(idle.back());
        idle.pop_back();
        return taken;
    }
    void give_back(unsigned threads, std::unique_ptr<TbbThreads> unused) {
        const std::lock_guard lock(mutex_);
        idle_[threads].push_back(std::move(unused));
    }

private:
    std::mutex mutex_;
    std::map<unsigned, std::vector<std::unique_ptr<TbbThreads>>> idle_;
};

IdleThreads& idle_threads() {
    static auto* const idle = new IdleThreads();
    return *idle;
}

}  // namespace

Team::Team(unsigned threads) : threads_(thread_count(threads)) {
    if (threads_ > 1) tbb_ = idle_threads().take(threads_);
}

Team::~Team() {
    if (tbb_) idle_threads().give_back(threads_, std::move(tbb_));
}

void Team::for_each(std::size_t count, const std::function<void(std::size_t, unsigned)>& body) {
    if (threads_ == 1 || count <= 1) {
        for (std::size_t i = 0; i < count; ++i) body(i, 0);
        return;
    }
    // One counter assigns indices in ascending order, so that low indices, for which a consumer may wait, finish first.
    std::atomic<std::size_t> next = 0;
    const auto work = [&](unsigned worker) {
        try {
            for (std::size_t i = next++; i < count; i = next++) body(i, worker);
        } catch (...) {
            next = count;
            throw;
        }
    };
    tbb_->run(unsigned(std::min<std::size_t>(threads_, count)), work);
}

void Team::with_helpers(const std::function<void()>& lead, const std::function<void()>& help) {
    if (threads_ == 1) return lead();
    std::exception_ptr failed;
    const auto leading = [&] {
        try {
            lead();
        } catch (...) {
            failed = std::current_exception();
        }
    };
    tbb_->run_with_helpers(threads_ - 1, leading, help);
    if (failed) std::rethrow_exception(failed);
}

}  // namespace octopair
