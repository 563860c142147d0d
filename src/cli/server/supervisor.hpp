// Supervisor: the program that started the server and watches it, for example systemd (sd_notify(3), sd_listen_fds(3)).
//
// A build without libsystemd sends no reports. A server that no program supervises has no supervisor, and sends no reports either.
#pragma once

#include <thread>

#include "base/descriptor.hpp"

namespace octopair::service {
class Server;
}  // namespace octopair::service

namespace octopair::cli {

/// Returns the listening socket that the supervisor passed to this process. Throws: Error{usage} if it did not pass exactly one.
Descriptor passed_socket();

class Supervisor {
public:
    /// Reports that the server is ready. If the supervisor asks for it, reports twice per interval that the server works, until this object
    /// is destroyed. Borrows the server.
    explicit Supervisor(const service::Server& server);
    Supervisor(const Supervisor&) = delete;
    Supervisor& operator=(const Supervisor&) = delete;
    ~Supervisor();

    /// Reports that the server takes no more jobs and ends.
    static void report_stopping();

private:
    std::jthread thread_;
};

}  // namespace octopair::cli
