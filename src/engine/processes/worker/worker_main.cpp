// octopair-worker: the program of worker processes. Only the process engine starts it.
#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <system_error>

#include "engine/processes/worker/worker.hpp"
#include "octopair/error.hpp"

namespace {

/// Makes the system kill this process when its parent ends. start_child() does this too, but another program may have started this
/// process. Ends this process if the parent, which made the socket, has ended before this call.
void die_with_parent() {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    ucred maker{};
    socklen_t size = sizeof(maker);
    const int got = ::getsockopt(octopair::worker_socket, SOL_SOCKET, SO_PEERCRED, &maker, &size);
    if (got == 0 && maker.pid != ::getppid()) ::_exit(0);
}

}  // namespace

int main(int count, char** arguments) {
    unsigned slot = 0;
    const char* const text = count == 2 ? arguments[1] : "";
    const auto [end, error] = std::from_chars(text, text + std::strlen(text), slot);
    if (count != 2 || error != std::errc() || *end != 0 || ::fcntl(octopair::worker_socket, F_GETFD) < 0) {
        std::fputs("octopair-worker is started by programs that use octopair's process engine\n", stderr);
        return 2;
    }
    die_with_parent();
    try {
        octopair::run_worker(octopair::Descriptor(octopair::worker_socket), slot, nullptr, [] { ::_exit(0); });
    } catch (const octopair::Error& failure) {
        std::fprintf(stderr, "octopair-worker: %s\n", failure.what());
        return failure.code() == octopair::ErrorCode::resource_limit ? octopair::worker_lacks_resources : 1;
    } catch (const std::bad_alloc&) {
        return octopair::worker_lacks_resources;
    } catch (const std::system_error&) {  // no thread
        return octopair::worker_lacks_resources;
    } catch (const std::exception& failure) {
        std::fprintf(stderr, "octopair-worker: %s\n", failure.what());
        return 1;
    }
}
