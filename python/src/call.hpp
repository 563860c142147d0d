// Calls of the C++ library from Python: without the GIL, and so that signal handlers of Python run meanwhile.
//
// - A call from a thread other than the main thread runs on this thread.
// - A long call from the main thread runs on a helper thread. The main thread waits and runs signal handlers every few milliseconds,
//   because Python runs them on this thread alone. If a handler raises (KeyboardInterrupt), the call is cancelled, and the exception
//   propagates.
// - After a fork, calls in the child throw Error{usage}, because the threads of the library do not exist there.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <stop_token>
#include <thread>

namespace octopair::python {

namespace py = pybind11;

/// Calls with at most this many objects are short enough to run on the main thread: pairs of 4,096 equal boxes take 30 ms.
inline constexpr std::uint64_t small_call = 4096;

/// Progress of a call as an optional Python callable, which receives a number from 0 to 1. Called on the thread of the caller.
struct CallSize {
    std::uint64_t objects = 0;
    py::object progress = py::none();
};

/// Receives the fraction of a call that is done. The waiting thread passes it to Python.
class ProgressValue {
public:
    void set(double fraction) { fraction_.store(fraction, std::memory_order_relaxed); }
    double get() const { return fraction_.load(std::memory_order_relaxed); }

private:
    std::atomic<double> fraction_ = 0;
};

/// Runs `work` without the GIL. `work` must stop after a stop request.
/// Requires: the GIL. Throws: exceptions of `work`, of signal handlers and of the progress callable; Error{usage} after a fork.
void call(const CallSize& size, const std::function<void(std::stop_token, ProgressValue&)>& work);

/// Marks the library as used, and throws Error{usage} in a process that was forked from a process that used the library.
void check_not_forked();
/// Returns true in such a forked process. Objects with threads must not be destroyed there.
bool is_forked();

/// Deletes an object without the GIL, because its destruction may wait for threads that need the GIL. Leaks it after a fork.
struct ReleasedDelete {
    template <typename Object>
    void operator()(Object* object) const {
        if (is_forked()) return;
        if (PyGILState_Check() == 0) {
            delete object;
            return;
        }
        const py::gil_scoped_release released;
        delete object;
    }
};

/// Makes calls of one object run one after another. Threads wait for their turn without the GIL.
class Turn {
public:
    class Holder {
    public:
        explicit Holder(Turn& turn);
        Holder(const Holder&) = delete;
        Holder& operator=(const Holder&) = delete;
        ~Holder();

    private:
        Turn& turn_;
    };

private:
    std::mutex mutex_;
    std::atomic<std::thread::id> owner_ = {};
};

}  // namespace octopair::python
