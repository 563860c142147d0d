#include "parallel/team.hpp"

#include <algorithm>
#include <atomic>
#include <exception>

#include "base/control_group.hpp"
#include "parallel/tbb_threads.hpp"

namespace octopair {

namespace {

unsigned thread_count(unsigned requested) { return requested > 0 ? requested : available_cores(); }

}  // namespace

Team::Team(unsigned threads) : threads_(thread_count(threads)) {
    if (threads_ > 1) tbb_ = std::make_unique<TbbThreads>(threads_);
}

Team::~Team() = default;

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
