// Calls of the C++ library from Python: without the GIL, and so that signal handlers of Python run meanwhile.
//
// - Python runs signal handlers only on the main thread, and only between its instructions. While the main thread is in a call, a
//   watcher thread receives the signals and stops the call. Then the handlers run. If one raises (KeyboardInterrupt), the exception
//   propagates. Otherwise the call is repeated on a helper thread, while the main thread runs handlers every few milliseconds.
// - A call with few objects is not stopped, because it is short.
// - A call that cannot be repeated, or that reports progress, runs on a helper thread at once.
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
#include <vector>

namespace octopair::python {

namespace py = pybind11;

/// Calls with at most this many objects are too short to be stopped: all pairs of 4,096 equal boxes take 30 ms.
inline constexpr std::uint64_t small_call = 4096;

struct CallMode {
    std::uint64_t objects = ~std::uint64_t(0);  ///< number of objects, if it bounds the time
    py::object progress =
        py::none();          ///< a callable that receives a number from 0 to 1, on the thread of the caller; or None
    bool repeatable = true;  ///< a call that was stopped may be made again
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
void call(const CallMode& mode, const std::function<void(std::stop_token, ProgressValue&)>& work);

/// Marks the library as used, and throws Error{usage} in a process that was forked from a process that used the library.
void check_not_forked();
/// Returns true in such a forked process. Objects with threads must not be destroyed there.
bool is_forked();

/// Releases the GIL until its end. If the interpreter ends meanwhile, threads other than the main thread wait here for the end of the
/// process; pybind11's class would abort it.
class Unlocked {
public:
    Unlocked() : state_(PyEval_SaveThread()) {}
    Unlocked(const Unlocked&) = delete;
    Unlocked& operator=(const Unlocked&) = delete;
    ~Unlocked() noexcept(false);

private:
    PyThreadState* state_;
};

/// Takes the GIL on a thread of the library, for a callback. The interpreter waits with its end until no thread is in a callback: otherwise
/// CPython would end the thread by pthread_exit, which the library does not expect.
class Locked {
public:
    /// Throws: Error{cancelled} if the interpreter ends.
    Locked();
    Locked(const Locked&) = delete;
    Locked& operator=(const Locked&) = delete;
    ~Locked();

private:
    PyGILState_STATE state_;
};

/// Deletes an object without the GIL, because its destruction may wait for threads that need the GIL. Leaks it after a fork.
struct ReleasedDelete {
    template <typename Object>
    void operator()(Object* object) const {
        if (is_forked()) return;
        if (PyGILState_Check() == 0) {
            delete object;
            return;
        }
        const Unlocked unlocked;
        delete object;
    }
};

/// Makes calls of one object run one after another. Threads wait for their turn without the GIL, and run signal handlers meanwhile.
class Turn {
public:
    class Holder {
    public:
        /// Throws: Error{usage} within a call of this object, in a signal handler or a callback, and after a fork; exceptions of
        /// signal handlers.
        explicit Holder(Turn& turn);
        Holder(const Holder&) = delete;
        Holder& operator=(const Holder&) = delete;
        ~Holder();

    private:
        Turn& turn_;
    };

    /// Throws: Error{usage} within a call of this object, in a signal handler or a callback, and after a fork.
    void check_free() const;

private:
    std::timed_mutex mutex_;
    std::atomic<std::thread::id> owner_ = {};
};

/// While this exists, this thread runs a callback of a call that holds the turns. Holders of these turns throw instead of waiting.
class Callback {
public:
    explicit Callback(std::vector<Turn*> turns);
    Callback(const Callback&) = delete;
    Callback& operator=(const Callback&) = delete;
    ~Callback();

private:
    std::size_t before_;
};

/// Prepares a module for the end of the interpreter. To be called once, by each module.
void watch_end_of_interpreter();

// errors.cpp

/// Makes the module raise the exceptions of octopair/_errors.py for Error and for a lack of memory. Each module needs this once.
void register_errors();

}  // namespace octopair::python
