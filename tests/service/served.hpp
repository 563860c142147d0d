// A server in the test's process, on a Unix socket in a temporary folder.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "io/temporary.hpp"
#include "octopair/client.hpp"
#include "service/server/server.hpp"
#include "service/server/server_options.hpp"

namespace octopair::test {

class Served {
public:
    using Change = std::function<void(service::ServerOptions&)>;

    /// Starts a server with a local engine of two threads, unless `change` sets other options.
    explicit Served(const Change& change = {});

    const std::string& address() const { return address_; }
    service::Server& server() { return *server_; }
    service::ServerLoad load() const { return server_->load(); }
    /// Waits until the server has no jobs and uses no memory for jobs. Returns whether this happened.
    bool comes_to_rest() const;

    void stop() { server_ = nullptr; }
    void start();

    std::unique_ptr<Engine> client(std::chrono::milliseconds patience = std::chrono::seconds(60)) const;

private:
    TemporaryDirectory folder_;
    service::ServerOptions options_;
    std::string address_;
    std::unique_ptr<service::Server> server_;
};

/// Expects that a job of three boxes finds its pair. Throws: the job's Error.
void check_serves(const std::string& address);

/// Fails the test unless `call` throws Error{resource_limit} with the name and value of the limit.
void expect_refused(const std::string& limit, std::uint64_t allowed, const std::function<void()>& call);

}  // namespace octopair::test
