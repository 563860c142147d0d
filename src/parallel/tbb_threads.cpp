#include "parallel/tbb_threads.hpp"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#include <exception>
#include <mutex>
#include <stdexcept>
#include <string>

#include "base/floating_point_scope.hpp"
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

/// Raises oneTBB's thread limit to the size of the largest team. By default the limit is the number of cores, and oneTBB prints
/// a warning to standard error if a team is larger.
void allow_threads(unsigned threads) {
    using oneapi::tbb::global_control;
    static std::mutex mutex;
    static std::unique_ptr<global_control> allowed;
    const std::lock_guard lock(mutex);
    const auto limit = global_control::max_allowed_parallelism;
    if (threads <= global_control::active_value(limit)) return;
    allowed = nullptr;  // if several limits exist, the lowest counts
    allowed = std::make_unique<global_control>(limit, threads);
}

/// Tells the thread sanitizer the order of one call: everything before the call happens before its tasks, and the tasks happen
/// before the call returns.
class TaskOrder {
public:
    TaskOrder() { release(); }
    ~TaskOrder() { acquire(); }
    TaskOrder(const TaskOrder&) = delete;
    TaskOrder& operator=(const TaskOrder&) = delete;

    /// Calls `body` as a task. Exceptions propagate. Sets the default floating-point state, because oneTBB runs a task in the
    /// state of the thread that first used oneTBB.
    template <typename Body>
    void task(Body&& body) {
        acquire();
        const ReleaseAtEnd release_at_end{*this};
        const FloatingPointScope scope;
        body();
    }

private:
    struct ReleaseAtEnd {
        TaskOrder& order;
        ~ReleaseAtEnd() { order.release(); }
    };

#ifdef OCTOPAIR_THREAD_SANITIZER
    void release() { __tsan_release(this); }
    void acquire() { __tsan_acquire(this); }
#else
    void release() {}
    void acquire() {}
#endif
};

/// Stores the first exception of several tasks. So a caller can tell exceptions of tasks from exceptions of oneTBB itself.
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

/// Calls `body`, which starts threads. oneTBB throws a runtime_error if the system cannot create a thread.
/// Throws: Error{resource_limit} in that case.
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

void TbbThreads::run_with_helpers(unsigned helpers, const std::function<void()>& lead,
                                  const std::function<void()>& help) {
    TaskOrder order;
    start([&] {
        arena_->arena.execute([&] {
            oneapi::tbb::task_group group;
            try {
                for (unsigned i = 0; i < helpers; ++i) group.run([&] { order.task(help); });
            } catch (const std::runtime_error&) {
                // The system cannot create a thread. Fewer helpers are enough, and those that run wait for `lead`.
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
