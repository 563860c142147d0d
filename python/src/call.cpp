#include "call.hpp"

#include <fcntl.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <utility>
#include <vector>

#include "octopair/error.hpp"

namespace octopair::python {

namespace {

using namespace std::chrono_literals;

constexpr auto signal_interval = 10ms;

std::atomic<bool> used = false;
std::atomic<bool> forked = false;

/// A thread that runs one call at a time for the main thread.
class Helper {
public:
    Helper() : thread_([this] { serve(); }) { thread_.detach(); }

    void start(std::function<void()> work) {
        const std::lock_guard lock(mutex_);
        work_ = std::move(work);
        ended_ = false;
        changed_.notify_all();
    }
    /// Returns true if the work has ended.
    bool wait(std::chrono::milliseconds time) {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, time, [&] { return ended_; });
    }
    void wait() {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return ended_; });
    }

private:
    void serve() {
        std::unique_lock lock(mutex_);
        for (;;) {
            changed_.wait(lock, [&] { return work_ != nullptr; });
            const std::function<void()> work = std::exchange(work_, nullptr);
            lock.unlock();
            work();
            lock.lock();
            ended_ = true;
            changed_.notify_all();
        }
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    std::function<void()> work_;
    bool ended_ = true;
    std::thread thread_;  // last: it uses the other members
};

/// Helpers that wait for work. A call within a signal handler or a progress callable needs a second helper. Never destroyed, because
/// its threads run until the process ends.
class Helpers {
public:
    Helper* take() {
        const std::lock_guard lock(mutex_);
        if (idle_.empty()) return new Helper();
        Helper* helper = idle_.back();
        idle_.pop_back();
        return helper;
    }
    void give_back(Helper* helper) {
        const std::lock_guard lock(mutex_);
        idle_.push_back(helper);
    }

private:
    std::mutex mutex_;
    std::vector<Helper*> idle_;
};

Helpers& helpers() {
    static auto* const all = new Helpers();
    return *all;
}

std::atomic<bool> interpreter_ends = false;
/// Threads that take the GIL, or run a callback. They started before interpreter_ends was set.
std::atomic<int> threads_at_gil = 0;
std::atomic<unsigned long> main_thread = 0;
/// Turns of the calls whose callback this thread runs.
thread_local std::vector<Turn*> callback_turns;

bool is_main_thread_id() { return PyThread_get_thread_ident() == main_thread; }

/// Requires: the GIL.
bool is_main_thread() {
    if (main_thread == 0)
        main_thread = py::module_::import("threading").attr("main_thread")().attr("ident").cast<unsigned long>();
    return is_main_thread_id();
}

/// Stops the call of the main thread when a signal arrives that Python handles. CPython writes the number of each such signal to the
/// "wakeup" file descriptor. Never destroyed, because its thread runs until the process ends.
class SignalWatcher {
public:
    /// Directs signals to the watcher during a call of the main thread. Requires: the GIL, in both functions.
    class Scope {
    public:
        Scope(SignalWatcher& watcher, std::stop_source& stop) : watcher_(watcher) {
            watcher.watch(&stop);
            former_ = set_wakeup_descriptor(watcher.pipe_[1]);
        }
        Scope(const Scope&) = delete;
        Scope& operator=(const Scope&) = delete;
        ~Scope() {
            try {
                set_wakeup_descriptor(former_);
            } catch (const py::error_already_set&) {
                former_ = -1;  // another thread closed the descriptor meanwhile
                set_wakeup_descriptor(former_);
            }
            for (const char number : watcher_.watch(nullptr)) {
                // The event loop that has the former descriptor receives the signal, too. If its buffer is full, it will wake up anyway.
                if (former_ >= 0) static_cast<void>(!write(former_, &number, 1));
            }
        }

    private:
        SignalWatcher& watcher_;
        int former_;
    };

    SignalWatcher() {
        if (pipe2(pipe_.data(), O_CLOEXEC) != 0 || fcntl(pipe_[1], F_SETFL, O_NONBLOCK) != 0) {
            throw Error(ErrorCode::resource_limit, "no file descriptors are left to watch signals");
        }
        std::thread([this] { serve(); }).detach();
    }

private:
    /// Calls signal.set_wakeup_fd. Returns the former descriptor, or -1.
    static int set_wakeup_descriptor(int descriptor) {
        static const py::object& set = *new py::object(py::module_::import("signal").attr("set_wakeup_fd"));
        return set(descriptor, py::arg("warn_on_full_buffer") = false).cast<int>();
    }
    void serve() {
        char number = 0;
        while (read(pipe_[0], &number, 1) == 1) {
            const std::lock_guard lock(mutex_);
            received_.push_back(number);
            if (stop_ != nullptr) stop_->request_stop();
        }
    }
    /// Watches another call. Returns the signals that the watcher has received.
    std::vector<char> watch(std::stop_source* stop) {
        const std::lock_guard lock(mutex_);
        stop_ = stop;
        return std::exchange(received_, {});
    }

    std::array<int, 2> pipe_ = {};
    std::mutex mutex_;
    std::stop_source* stop_ = nullptr;
    std::vector<char> received_;
};

SignalWatcher& signal_watcher() {
    static auto* const watcher = new SignalWatcher();
    return *watcher;
}

/// Runs `work` on the main thread. Returns false if a signal stopped it whose handler did not raise.
/// Throws: exceptions of `work` and of signal handlers.
bool call_watched(const std::function<void(std::stop_token)>& work) {
    std::stop_source stop;
    std::exception_ptr failure;
    {
        const SignalWatcher::Scope scope(signal_watcher(), stop);
        const Unlocked unlocked;
        try {
            work(stop.get_token());
        } catch (...) {
            failure = std::current_exception();
        }
    }
    if (failure && stop.stop_requested()) {
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        return false;
    }
    if (failure) std::rethrow_exception(failure);
    return true;
}

/// Passes the progress to Python. Throws: exceptions of the callable.
class Reporter {
public:
    Reporter(const py::object& callable, const ProgressValue& value) : callable_(callable), value_(value) {}

    void report() {
        if (callable_.is_none() || value_.get() <= last_) return;
        last_ = value_.get();
        callable_(last_);
    }

private:
    const py::object& callable_;
    const ProgressValue& value_;
    double last_ = -1;
};

/// Runs `work` on a helper thread, and signal handlers and `reporter` on this one.
void call_on_helper(const std::function<void(std::stop_token)>& work, Reporter& reporter) {
    std::exception_ptr failure;
    std::stop_source stop;
    Helper* const helper = helpers().take();
    helper->start([&] {
        try {
            work(stop.get_token());
        } catch (...) {
            failure = std::current_exception();
        }
    });
    try {
        for (;;) {
            bool ended = false;
            {
                const Unlocked unlocked;
                ended = helper->wait(signal_interval);
            }
            if (ended) break;
            if (PyErr_CheckSignals() != 0) throw py::error_already_set();
            reporter.report();
        }
    } catch (...) {
        stop.request_stop();
        {
            const Unlocked unlocked;
            helper->wait();
        }
        helpers().give_back(helper);
        throw;
    }
    helpers().give_back(helper);
    if (failure) std::rethrow_exception(failure);
}

}  // namespace

bool is_forked() { return forked.load(std::memory_order_relaxed); }

void check_not_forked() {
    if (is_forked()) {
        throw Error(
            ErrorCode::usage,
            "this process was forked after octopair was used; threads do not survive a fork. Start processes with "
            "multiprocessing.get_context('spawn'), or use octopair only after the fork");
    }
    if (!used.exchange(true)) pthread_atfork(nullptr, nullptr, [] { forked = true; });
}

void call(const CallMode& mode, const std::function<void(std::stop_token, ProgressValue&)>& work) {
    static std::atomic<bool> handlers_return = false;
    check_not_forked();
    ProgressValue value;
    const auto stoppable = [&](const std::stop_token& stop) { work(stop, value); };
    if (mode.progress.is_none() && (mode.objects <= small_call || !is_main_thread())) {
        const Unlocked unlocked;
        stoppable({});
        return;
    }
    if (mode.progress.is_none() && mode.repeatable && !handlers_return) {
        if (call_watched(stoppable)) return;
        // The process has signal handlers that do not raise. They may be frequent, so that no call would end.
        handlers_return = true;
    }
    Reporter reporter(mode.progress, value);
    call_on_helper(stoppable, reporter);
    value.set(1);
    reporter.report();
}

Unlocked::~Unlocked() noexcept(false) {
    // A thread that takes the GIL while the interpreter ends is ended by pthread_exit. This thread may hold locks, so it waits for the
    // end of the process instead.
    ++threads_at_gil;
    while (interpreter_ends && !is_main_thread_id()) {
        --threads_at_gil;
        pause();
        ++threads_at_gil;
    }
    PyEval_RestoreThread(state_);
    --threads_at_gil;
}

Locked::Locked() {
    ++threads_at_gil;
    if (interpreter_ends) {
        --threads_at_gil;
        throw Error(ErrorCode::cancelled, "the interpreter ends");
    }
    state_ = PyGILState_Ensure();
}

Locked::~Locked() {
    PyGILState_Release(state_);
    --threads_at_gil;
}

void watch_end_of_interpreter() {
    is_main_thread();
    const auto wait_for_threads = [] {
        interpreter_ends = true;
        const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(5);
        while (threads_at_gil > 0 && std::chrono::steady_clock::now() < deadline) {
            PyThreadState* const state = PyEval_SaveThread();
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
            PyEval_RestoreThread(state);
        }
    };
    py::module_::import("atexit").attr("register")(py::cpp_function(wait_for_threads));
}

Callback::Callback(std::vector<Turn*> turns) : before_(callback_turns.size()) {
    callback_turns.insert(callback_turns.end(), turns.begin(), turns.end());
}

Callback::~Callback() { callback_turns.resize(before_); }

void Turn::check_free() const {
    check_not_forked();
    const bool in_callback = std::find(callback_turns.begin(), callback_turns.end(), this) != callback_turns.end();
    if (in_callback || owner_ == std::this_thread::get_id()) {
        throw Error(
            ErrorCode::usage,
            "a call of this object is running on this thread; a signal handler or callback may not make another");
    }
}

Turn::Holder::Holder(Turn& turn) : turn_(turn) {
    turn.check_free();
    bool mine = turn.mutex_.try_lock();
    while (!mine) {
        {
            const Unlocked unlocked;
            mine = turn.mutex_.try_lock_for(signal_interval);
        }
        if (mine) break;
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        if (interpreter_ends)
            throw Error(ErrorCode::usage, "the interpreter ends, and another thread uses this object");
    }
    turn.owner_ = std::this_thread::get_id();
}

Turn::Holder::~Holder() {
    turn_.owner_ = std::thread::id();
    turn_.mutex_.unlock();
}

}  // namespace octopair::python
