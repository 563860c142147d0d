#include "engine/processes/client/worker_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <system_error>
#include <utility>

#include "engine/processes/client/spawner.hpp"
#include "engine/processes/worker/worker.hpp"
#include "octopair/error.hpp"

namespace octopair {

namespace {

constexpr auto wait_by_handle = idtype_t(3);  // P_PIDFD, which not all headers have

/// One of so many polls also reads /proc, which costs more.
constexpr unsigned polls_per_proc_read = 8;

[[noreturn]] void throw_cannot_start(const std::string& program, int error) {
    const bool exhausted = error == EAGAIN || error == ENOMEM || error == EMFILE || error == ENFILE;
    throw Error(exhausted ? ErrorCode::resource_limit : ErrorCode::engine_failed,
                "cannot start the worker program " + program + ": " + std::strerror(error));
}

/// Start conditions of a worker: its socket, no other descriptor of the application, no signal blocked or ignored, and its
/// own process group. An interrupt from the keyboard then reaches only the application.
class SpawnSettings {
public:
    explicit SpawnSettings(int socket) {
        bool good = ::posix_spawn_file_actions_init(&actions_) == 0;
        good = good && ::posix_spawnattr_init(&attributes_) == 0;
        good = good && ::posix_spawn_file_actions_adddup2(&actions_, socket, worker_socket) == 0;
        good = good && ::posix_spawn_file_actions_addopen(&actions_, 0, "/dev/null", O_RDONLY, 0) == 0;
        good = good && ::posix_spawn_file_actions_addopen(&actions_, 1, "/dev/null", O_WRONLY, 0) == 0;
        // If the application has closed stderr, a descriptor of shared memory would get its number and receive error text.
        if (::fcntl(2, F_GETFD) < 0) {
            good = good && ::posix_spawn_file_actions_addopen(&actions_, 2, "/dev/null", O_WRONLY, 0) == 0;
        }
        good = good && ::posix_spawn_file_actions_addclosefrom_np(&actions_, worker_socket + 1) == 0;
        sigset_t all, none;
        ::sigfillset(&all);
        ::sigemptyset(&none);
        ::sigdelset(&all, SIGKILL);
        ::sigdelset(&all, SIGSTOP);
        good = good && ::posix_spawnattr_setsigdefault(&attributes_, &all) == 0;
        good = good && ::posix_spawnattr_setsigmask(&attributes_, &none) == 0;
        good = good && ::posix_spawnattr_setpgroup(&attributes_, 0) == 0;
        constexpr short flags = POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP;
        good = good && ::posix_spawnattr_setflags(&attributes_, flags) == 0;
        if (!good) throw Error(ErrorCode::resource_limit, "cannot prepare to start a worker process");
    }
    ~SpawnSettings() {
        ::posix_spawn_file_actions_destroy(&actions_);
        ::posix_spawnattr_destroy(&attributes_);
    }
    SpawnSettings(const SpawnSettings&) = delete;
    SpawnSettings& operator=(const SpawnSettings&) = delete;

    const posix_spawn_file_actions_t* actions() const { return &actions_; }
    const posix_spawnattr_t* attributes() const { return &attributes_; }

private:
    posix_spawn_file_actions_t actions_{};
    posix_spawnattr_t attributes_{};
};

/// Returns true if the process ended within the time; -1: waits without a limit.
bool wait_for_end(const Descriptor& handle, int max_milliseconds) {
    pollfd waiting{handle.number(), POLLIN, 0};
    int ready = 0;
    do {
        ready = ::poll(&waiting, 1, max_milliseconds);
    } while (ready < 0 && errno == EINTR);
    return ready > 0;
}

std::string describe_end(const siginfo_t& info) {
    if (info.si_pid == 0) return "for an unknown reason";
    if (info.si_code == CLD_EXITED) return "with exit status " + std::to_string(info.si_status);
    return "by signal " + std::to_string(info.si_status);
}

}  // namespace

WorkerProcess::WorkerProcess(const std::string& program, unsigned slot) : owner_(::getpid()) {
    SocketPair sockets = make_socket_pair();
    const SpawnSettings settings(sockets.theirs.number());
    std::string name = "octopair-worker", number = std::to_string(slot);
    const std::array<char*, 3> arguments = {name.data(), number.data(), nullptr};
    int error = 0;
    try {
        run_on_spawner([&] {
            error = ::posix_spawn(&id_, program.c_str(), settings.actions(), settings.attributes(), arguments.data(),
                                  environ);
        });
    } catch (const std::system_error& no_thread) {
        error = no_thread.code().value();
    }
    if (error != 0) throw_cannot_start(program, error);
    handle_ = Descriptor(int(::syscall(SYS_pidfd_open, id_, 0)));
    if (!handle_.open() && errno != ESRCH) {  // ESRCH: it has ended, and the application has waited for it
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

std::string WorkerProcess::end() {
    if (!handle_.open()) return "for an unknown reason";
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
    return describe_end(info);
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
