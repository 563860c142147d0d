#include "base/child_process.hpp"

#include <fcntl.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <memory>

// The child uses the parent's memory, but another stack, until it runs the program. Sanitizers do not expect that.
#define OCTOPAIR_NOT_SANITIZED __attribute__((no_sanitize("address"), no_sanitize("thread"), no_sanitize("undefined")))

namespace octopair {

namespace {

constexpr int first_descriptor = 3;

/// Settings of the child. The child reads them in the memory of its parent.
struct Start {
    const char* path;
    char* const* arguments;
    const int* descriptors;
    int descriptor_count;
    bool keeps_stderr;
    int output, errors;
    pid_t parent;
    int error;  // errno of the child
};

/// Opens /dev/null as a descriptor. Returns false after an error.
OCTOPAIR_NOT_SANITIZED bool open_nothing(int descriptor) {
    const int opened = ::open("/dev/null", O_RDWR);
    if (opened < 0 || opened == descriptor) return opened >= 0;
    return ::dup2(opened, descriptor) >= 0 && ::close(opened) == 0;
}

OCTOPAIR_NOT_SANITIZED void close_from(int first) {
    if (::syscall(SYS_close_range, unsigned(first), ~0u, 0) == 0) return;
    rlimit limit{};  // Linux before 5.9
    (void)::getrlimit(RLIMIT_NOFILE, &limit);
    for (rlim_t descriptor = rlim_t(first); descriptor < limit.rlim_cur; ++descriptor) ::close(int(descriptor));
}

/// Gives the program its descriptors, and closes all others. Returns false after an error.
OCTOPAIR_NOT_SANITIZED bool arrange_descriptors(const Start& start) {
    const int behind = first_descriptor + start.descriptor_count;
    // First copies all descriptors to numbers above those that the program gets. So no descriptor is overwritten before its copy.
    int copies[ChildProgram::max_descriptors];
    for (int i = 0; i < start.descriptor_count; ++i) {
        copies[i] = ::fcntl(start.descriptors[i], F_DUPFD, behind);
        if (copies[i] < 0) return false;
    }
    for (int i = 0; i < start.descriptor_count; ++i) {
        if (::dup2(copies[i], first_descriptor + i) < 0) return false;
    }
    const int output = start.output < 0 ? -1 : ::fcntl(start.output, F_DUPFD, behind);
    const int errors = start.errors < 0 ? -1 : ::fcntl(start.errors, F_DUPFD, behind);
    const bool keeps_stderr = errors < 0 && start.keeps_stderr && ::fcntl(2, F_GETFD) >= 0;
    for (int standard = 0; standard < (keeps_stderr ? 2 : 3); ++standard) {
        if (!open_nothing(standard)) return false;
    }
    if (output >= 0 && ::dup2(output, 1) < 0) return false;
    if (errors >= 0 && ::dup2(errors, 2) < 0) return false;
    close_from(behind);
    return true;
}

/// The result becomes the exit status.
OCTOPAIR_NOT_SANITIZED int run_child(void* argument) {
    Start& start = *static_cast<Start*>(argument);
    // The system kills this process when its parent ends. The parent may have ended before this request: then getppid() differs.
    if (::prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || ::getppid() != start.parent) {
        start.error = ESRCH;
        return 127;
    }
    struct sigaction standard {};
    standard.sa_handler = SIG_DFL;
    for (int signal = 1; signal < NSIG; ++signal) (void)::sigaction(signal, &standard, nullptr);
    sigset_t none;
    ::sigemptyset(&none);
    if (::setpgid(0, 0) == 0 && arrange_descriptors(start) && ::sigprocmask(SIG_SETMASK, &none, nullptr) == 0)
        ::execve(start.path, start.arguments, environ);
    start.error = errno;
    return 127;
}

}  // namespace

pid_t start_child(const ChildProgram& program) {
    constexpr std::size_t stack_bytes = 64 << 10;
    const std::unique_ptr<std::byte[]> stack(new std::byte[stack_bytes]);
    Start start{program.path.c_str(),
                program.arguments.data(),
                program.descriptors.data(),
                int(program.descriptors.size()),
                program.keeps_stderr,
                program.output,
                program.errors,
                ::getpid(),
                0};
    // No handler of a signal must run in the child, which uses the memory of this process.
    sigset_t all, before;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &before);
    // CLONE_VFORK: this thread waits until the child runs the program or has ended.
    const pid_t child = ::clone(run_child, stack.get() + stack_bytes, CLONE_VM | CLONE_VFORK | SIGCHLD, &start);
    const int error = child < 0 ? errno : start.error;
    ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
    if (error == 0) return child;
    while (child > 0 && ::waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
    }
    errno = error;
    return -1;
}

}  // namespace octopair
