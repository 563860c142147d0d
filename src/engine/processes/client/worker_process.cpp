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
#include <utility>

#include "engine/processes/worker/worker.hpp"
#include "octopair/error.hpp"

namespace octopair {

namespace {

constexpr auto wait_by_handle = idtype_t(3);  // P_PIDFD, which not all headers have

constexpr unsigned looks_per_long_look = 8;

[[noreturn]] void throw_cannot_start(const std::string& program, int error) {
    const bool exhausted = error == EAGAIN || error == ENOMEM || error == EMFILE || error == ENFILE;
    throw Error(exhausted ? ErrorCode::resource_limit : ErrorCode::engine_failed,
                "cannot start the worker program " + program + ": " + std::strerror(error));
}

/// What a worker begins with: its socket, no other descriptor of the application, no signal blocked or ignored, and a
/// process group of its own, so that an interrupt from the keyboard is the application's to handle.
class SpawnSettings {
public:
    explicit SpawnSettings(int socket) {
        bool good = ::posix_spawn_file_actions_init(&actions_) == 0;
        good = good && ::posix_spawnattr_init(&attributes_) == 0;
        good = good && ::posix_spawn_file_actions_adddup2(&actions_, socket, worker_socket) == 0;
        good = good && ::posix_spawn_file_actions_addopen(&actions_, 0, "/dev/null", O_RDONLY, 0) == 0;
        good = good && ::posix_spawn_file_actions_addopen(&actions_, 1, "/dev/null", O_WRONLY, 0) == 0;
        // Where the application has closed it, a descriptor of shared memory would become what errors are written to.
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

bool ended(const Descriptor& handle, int most_milliseconds) {
    pollfd waiting{handle.number(), POLLIN, 0};
    int ready = 0;
    do {
        ready = ::poll(&waiting, 1, most_milliseconds);
    } while (ready < 0 && errno == EINTR);
    return ready > 0;
}

std::string in_words(const siginfo_t& info) {
    if (info.si_pid == 0) return "of unknown cause";
    if (info.si_code == CLD_EXITED) return "with exit status " + std::to_string(info.si_status);
    return "by signal " + std::to_string(info.si_status);
}

}  // namespace

WorkerProcess::WorkerProcess(const std::string& program, unsigned slot) : owner_(::getpid()) {
    SocketPair sockets = make_socket_pair();
    const SpawnSettings settings(sockets.theirs.number());
    std::string name = "octopair-worker", number = std::to_string(slot);
    const std::array<char*, 3> arguments = {name.data(), number.data(), nullptr};
    const int error =
        ::posix_spawn(&id_, program.c_str(), settings.actions(), settings.attributes(), arguments.data(), environ);
    if (error != 0) throw_cannot_start(program, error);
    handle_ = Descriptor(int(::syscall(SYS_pidfd_open, id_, 0)));
    if (!handle_.open() && errno != ESRCH) {  // which says that it has ended, and was waited for by somebody
        const int reason = errno;
        ::kill(id_, SIGKILL);
        while (::waitpid(id_, nullptr, 0) < 0 && errno == EINTR) {
        }
        throw_cannot_start(program, reason);
    }
    socket_ = std::move(sockets.ours);
}

WorkerProcess::~WorkerProcess() { (void)end(); }

ProcessState WorkerProcess::look() {
    if (!handle_.open() || ended(handle_, 0)) return ProcessState::ended;
    siginfo_t info{};
    const int result = ::waitid(wait_by_handle, id_t(handle_.number()), &info, WSTOPPED | WNOHANG);
    if (result == 0 && info.si_pid != 0) return ProcessState::stopped;
    if (++looks_ % looks_per_long_look != 0 || !shown_as_stopped()) return ProcessState::runs;
    return ended(handle_, 0) ? ProcessState::ended : ProcessState::stopped;
}

/// A stop is told once, and may have been told to the application, waiting for its children.
bool WorkerProcess::shown_as_stopped() const {
    const Descriptor file(::open(("/proc/" + std::to_string(id_) + "/stat").c_str(), O_RDONLY | O_CLOEXEC));
    std::array<char, 128> text{};
    if (!file.open() || ::read(file.number(), text.data(), text.size() - 1) <= 0) return false;
    const char* const name_end = std::strrchr(text.data(), ')');
    return name_end != nullptr && std::strncmp(name_end, ") T", 3) == 0;
}

std::string WorkerProcess::end() {
    if (!handle_.open()) return "before";
    siginfo_t info{};
    if (::getpid() == owner_) {
        (void)::syscall(SYS_pidfd_send_signal, handle_.number(), SIGKILL, nullptr, 0);
        (void)ended(handle_, -1);
        // The application may have told the system to forget its children, or waited for all of them itself.
        while (::waitid(wait_by_handle, id_t(handle_.number()), &info, WEXITED) != 0 && errno == EINTR) {
        }
    }
    handle_ = Descriptor();
    socket_ = Descriptor();
    return in_words(info);
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
