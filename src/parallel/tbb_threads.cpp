#include "parallel/tbb_threads.hpp"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#include <mutex>

#include "parallel/team.hpp"

#ifdef OCTOPAIR_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace octopair {

struct TbbThreads::Arena {
    oneapi::tbb::task_arena arena;
};

namespace {

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

/// Of one call: tells the sanitizer that what was before it comes before its tasks, and these before its end.
class TaskOrder {
public:
    TaskOrder() { leave(); }
    ~TaskOrder() { enter(); }
    TaskOrder(const TaskOrder&) = delete;
    TaskOrder& operator=(const TaskOrder&) = delete;

    /// Calls `body` as a task; what it throws is passed on.
    template <typename Body>
    void task(Body&& body) {
        enter();
        const Leaving leaving{*this};
        body();
    }

private:
    struct Leaving {
        TaskOrder& order;
        ~Leaving() { order.leave(); }
    };

#ifdef OCTOPAIR_THREAD_SANITIZER
    void leave() { __tsan_release(this); }
    void enter() { __tsan_acquire(this); }
#else
    void leave() {}
    void enter() {}
#endif
};

}  // namespace

TbbThreads::TbbThreads(unsigned threads) {
    allow_threads(threads);
    arena_ = std::make_unique<Arena>(Arena{oneapi::tbb::task_arena(int(threads))});
}

TbbThreads::~TbbThreads() = default;

void TbbThreads::run(unsigned count, const std::function<void(unsigned)>& body) {
    TaskOrder order;
    const auto task = [&](unsigned i) { order.task([&] { body(i); }); };
    arena_->arena.execute([&] { oneapi::tbb::parallel_for(0u, count, task, oneapi::tbb::simple_partitioner()); });
}

void TbbThreads::run_beside(unsigned helpers, const std::function<void()>& lead, const std::function<void()>& help) {
    TaskOrder order;
    arena_->arena.execute([&] {
        oneapi::tbb::task_group group;
        for (unsigned i = 0; i < helpers; ++i) group.run([&] { order.task(help); });
        lead();
        group.wait();
    });
}

}  // namespace octopair
