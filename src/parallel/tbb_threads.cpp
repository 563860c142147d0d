#include "parallel/tbb_threads.hpp"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#include <exception>
#include <mutex>
#include <stdexcept>
#include <string>

#include "base/floating_point.hpp"
#include "octopair/error.hpp"
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

    /// Calls `body` as a task; what it throws is passed on. oneTBB gives a task the floating-point state of whoever began
    /// to use it, which may be any.
    template <typename Body>
    void task(Body&& body) {
        enter();
        const Leaving leaving{*this};
        const FloatingPointScope scope;
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

/// The first exception of several tasks, apart from what oneTBB itself may throw.
class FirstFailure {
public:
    template <typename Body>
    void guard(Body&& body) {
        try {
            body();
        } catch (...) {
            const std::lock_guard lock(mutex_);
            if (!first_) first_ = std::current_exception();
        }
    }
    void rethrow() const {
        if (first_) std::rethrow_exception(first_);
    }

private:
    std::mutex mutex_;
    std::exception_ptr first_;
};

/// Calls what starts threads; oneTBB says in a runtime_error that the system has none to give.
template <typename Body>
void start(Body&& body) {
    try {
        body();
    } catch (const std::runtime_error& error) {
        throw Error(ErrorCode::resource_limit, std::string("cannot start threads: ") + error.what());
    }
}

}  // namespace

TbbThreads::TbbThreads(unsigned threads) {
    allow_threads(threads);
    arena_ = std::make_unique<Arena>(Arena{oneapi::tbb::task_arena(int(threads))});
}

TbbThreads::~TbbThreads() = default;

void TbbThreads::run(unsigned count, const std::function<void(unsigned)>& body) {
    TaskOrder order;
    FirstFailure failure;
    const auto task = [&](unsigned i) { order.task([&] { failure.guard([&] { body(i); }); }); };
    start([&] {
        arena_->arena.execute([&] { oneapi::tbb::parallel_for(0u, count, task, oneapi::tbb::simple_partitioner()); });
    });
    failure.rethrow();
}

void TbbThreads::run_beside(unsigned helpers, const std::function<void()>& lead, const std::function<void()>& help) {
    TaskOrder order;
    start([&] {
        arena_->arena.execute([&] {
            oneapi::tbb::task_group group;
            try {
                for (unsigned i = 0; i < helpers; ++i) group.run([&] { order.task(help); });
            } catch (const std::runtime_error&) {
                // No thread to be had: fewer helpers will do, and those that run wait for the lead.
            }
            {
                const FloatingPointScope scope;
                lead();
            }
            group.wait();
        });
    });
}

}  // namespace octopair
