// Supervisor: the program that started the server and watches it.
#include <fcntl.h>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <stop_token>

#include "cli/server/serving.hpp"
#include "octopair/error.hpp"
#include "service/server/server.hpp"
#ifdef OCTOPAIR_WITH_SYSTEMD
#include <systemd/sd-daemon.h>
#endif

namespace octopair::cli {

#ifdef OCTOPAIR_WITH_SYSTEMD

namespace {

/// Reports once per `interval` that the server works, if its watchdog has run and its locks are free.
void report_life(const std::stop_token& stop, const service::Server& server, std::chrono::microseconds interval) {
    std::mutex mutex;
    std::condition_variable_any ended;
    std::unique_lock lock(mutex);
    std::uint64_t before = 0;
    while (!ended.wait_for(lock, stop, interval, [] { return false; }) && !stop.stop_requested()) {
        (void)server.load();
        if (const std::uint64_t beats = server.beats(); beats != before) {
            before = beats;
            (void)sd_notify(0, "WATCHDOG=1");
        }
    }
}

}  // namespace

Descriptor passed_socket() {
    const int count = sd_listen_fds(1);
    if (count != 1) {
        throw Error(ErrorCode::usage, "--listen systemd: systemd passed " + std::to_string(count > 0 ? count : 0) +
                                          " sockets; start the server by a socket unit with one ListenStream=");
    }
    Descriptor socket(SD_LISTEN_FDS_START);
    (void)::fcntl(socket.number(), F_SETFD, FD_CLOEXEC);
    if (sd_is_socket(socket.number(), AF_UNSPEC, SOCK_STREAM, 1) <= 0)
        throw Error(ErrorCode::usage, "--listen systemd: systemd passed a descriptor that is not a listening socket");
    return socket;
}

Supervisor::Supervisor(const service::Server& server) {
    (void)sd_notify(0, "READY=1");
    std::uint64_t microseconds = 0;
    if (sd_watchdog_enabled(0, &microseconds) <= 0) return;
    const std::chrono::microseconds interval(microseconds / 2);
    thread_ = std::jthread([&server, interval](const std::stop_token& stop) { report_life(stop, server, interval); });
}

void Supervisor::report_stopping() { (void)sd_notify(0, "STOPPING=1"); }

#else

Descriptor passed_socket() {
    throw Error(ErrorCode::usage, "--listen systemd: this octopair was built without libsystemd");
}

Supervisor::Supervisor(const service::Server&) {}

void Supervisor::report_stopping() {}

#endif

Supervisor::~Supervisor() = default;

}  // namespace octopair::cli
