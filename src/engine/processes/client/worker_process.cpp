#include "engine/processes/client/worker_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <condition_variable>
#include <csignal>
#include <cstring>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

#include "base/child_process.hpp"
#include "engine/processes/worker/worker.hpp"
#include "octopair/error.hpp"

namespace octopair {

namespace {

/// A thread that starts the workers, and lives as long as this process. The system sends the parent-death signal to a worker when the
/// thread that started the worker ends. A thread of the application may end long before its process.
class Spawner {
public:
    Spawner() : owner_(::getpid()) {
        // The thread takes no signals: they belong to the threads of the application.
        sigset_t all, before;
        ::sigfillset(&all);
        ::pthread_sigmask(SIG_SETMASK, &all, &before);
        try {
            std::thread([this] { serve(); }).detach();
        } catch (...) {
            ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
            throw;
        }
        ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
    }

    pid_t owner() const { return owner_; }

    void run(const std::function<void()>& work) {
        const std::lock_guard one_at_a_time(callers_);
        std::unique_lock lock(mutex_);
        work_ = &work;
        changed_.notify_all();
        changed_.wait(lock, [this] { return work_ == nullptr; });
    }

private:
    [[noreturn]] void serve() {
        std::unique_lock lock(mutex_);
        for (;;) {
            changed_.wait(lock, [this] { return work_ != nullptr; });
            (*work_)();
            work_ = nullptr;
            changed_.notify_all();
        }
    }

    const pid_t owner_;
    std::mutex callers_, mutex_;
    std::condition_variable changed_;
    const std::function<void()>* work_ = nullptr;
};

/// Runs `work` on the spawner thread and waits for it. In a process that was forked without that thread, runs it on this thread.
/// Requires: `work` does not throw. Throws: std::system_error if the thread cannot be started.
/// Thread safety: any thread may call it; one function runs at a time.
void run_on_spawner(const std::function<void()>& work) {
    static Spawner* const spawner = new Spawner;  // never destroyed, because its thread never ends
    spawner->owner() == ::getpid() ? spawner->run(work) : work();
}

constexpr auto wait_by_handle = idtype_t(3);  // P_PIDFD, which not all headers have

/// One poll in this many also reads the state from /proc, which takes longer than the other steps of a poll.
constexpr unsigned polls_per_proc_read = 8;

[[noreturn]] void throw_cannot_start(const std::string& program, int error) {
    const bool exhausted = error == EAGAIN || error == ENOMEM || error == EMFILE || error == ENFILE;
    throw Error(exhausted ? ErrorCode::resource_limit : ErrorCode::engine_failed,
                "cannot start the worker program " + program + ": " + std::strerror(error));
}

/// Waits for the end of a process. Returns true if it ended within the time. A time of -1 sets no limit.
bool wait_for_end(const Descriptor& handle, int max_milliseconds) {
    pollfd waiting{handle.number(), POLLIN, 0};
    int ready = 0;
    do {
        ready = ::poll(&waiting, 1, max_milliseconds);
    } while (ready < 0 && errno == EINTR);
    return ready > 0;
}

ProcessEnd end_of(const siginfo_t& info) {
    if (info.si_pid == 0) return {"for an unknown reason"};
    if (info.si_code == CLD_EXITED)
        return {"with exit status " + std::to_string(info.si_status), info.si_status == worker_lacks_resources};
    return {"by signal " + std::to_string(info.si_status)};
}

}  // namespace

WorkerProcess::WorkerProcess(const std::string& program, unsigned slot) : owner_(::getpid()) {
    SocketPair sockets = make_socket_pair();
    std::string name = "octopair-worker", number = std::to_string(slot);
    const std::array<char*, 3> arguments = {name.data(), number.data(), nullptr};
    const std::array<int, 1> descriptors = {sockets.theirs.number()};
    static_assert(worker_socket == 3, "the number of the first descriptor that a child gets");
    const ChildProgram child{program, arguments, descriptors, true};
    int error = 0;
    try {
        run_on_spawner([&] {
            id_ = start_child(child);
            error = id_ < 0 ? errno : 0;
        });
    } catch (const std::system_error& no_thread) {
        error = no_thread.code().value();
    }
    if (error != 0) throw_cannot_start(program, error);
    handle_ = Descriptor(int(::syscall(SYS_pidfd_open, id_, 0)));
    if (!handle_.open() && errno != ESRCH) {  // ESRCH: the worker has ended already, and the application has reaped it
        const int reason = errno;
        ::kill(id_, SIGKILL);
        while (::waitpid(id_, nullptr, 0) < 0 && errno == EINTR) {
        }
        throw_cannot_start(program, reason);
    }
    socket_ = std::move(sockets.ours);
}

WorkerProcess::~WorkerProcess() { (void)end(); }

ProcessState WorkerProcess::poll_state() {
    if (!handle_.open() || wait_for_end(handle_, 0)) return ProcessState::ended;
    siginfo_t info{};
    const int result = ::waitid(wait_by_handle, id_t(handle_.number()), &info, WSTOPPED | WNOHANG);
    if (result == 0 && info.si_pid != 0) return ProcessState::stopped;
    if (++polls_ % polls_per_proc_read != 0 || !is_stopped_in_proc()) return ProcessState::runs;
    return wait_for_end(handle_, 0) ? ProcessState::ended : ProcessState::stopped;
}

/// Reads the state from /proc. waitid() reports a stop only once, possibly to the application when it waits for its children.
bool WorkerProcess::is_stopped_in_proc() const {
    const Descriptor file(::open(("/proc/" + std::to_string(id_) + "/stat").c_str(), O_RDONLY | O_CLOEXEC));
    std::array<char, 128> text{};
    if (!file.open() || ::read(file.number(), text.data(), text.size() - 1) <= 0) return false;
    const char* const name_end = std::strrchr(text.data(), ')');
    return name_end != nullptr && std::strncmp(name_end, ") T", 3) == 0;
}

ProcessEnd WorkerProcess::end() {
    if (!handle_.open()) return end_of({});
    siginfo_t info{};
    if (::getpid() == owner_) {
        (void)::syscall(SYS_pidfd_send_signal, handle_.number(), SIGKILL, nullptr, 0);
        (void)wait_for_end(handle_, -1);
        // This fails if the application ignores SIGCHLD or has already waited for all its children.
        while (::waitid(wait_by_handle, id_t(handle_.number()), &info, WEXITED) != 0 && errno == EINTR) {
        }
    }
    handle_ = Descriptor();
    socket_ = Descriptor();
    return end_of(info);
}

bool WorkerProcess::send_region(std::uint32_t number, const SharedMemory& memory) {
    if (regions_.contains(number)) return true;
    if (!send_message(socket_, {ControlMessageKind::region, number, memory.size()}, memory.descriptor())) return false;
    regions_.insert(number);
    return true;
}

void WorkerProcess::forget_all_but(const std::function<bool(std::uint32_t)>& wanted) {
    std::erase_if(regions_, [&](std::uint32_t number) {
        return !wanted(number) && send_message(socket_, {ControlMessageKind::forget, number, 0});
    });
}

bool WorkerProcess::stop_pass(std::uint32_t pass) { return send_message(socket_, {ControlMessageKind::stop, pass, 0}); }

}  // namespace octopair
