// `octopair serve` as a separate program that a test can kill, stop and restart.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>

#include "io/temporary.hpp"

namespace octopair::test {

class ServerProgram {
public:
    struct Setting {
        std::string arguments = "--engine local --threads 2";
        std::string before = {};       ///< shell commands to run first, for example "ulimit -n 40;"
        std::string environment = {};  ///< "NAME=VALUE ..."
        std::string listen = {};       ///< value of --listen; empty: a socket in the folder
    };

    /// Starts the server on a Unix socket in a temporary folder.
    explicit ServerProgram(Setting setting);
    ServerProgram() : ServerProgram(Setting()) {}
    ServerProgram(const ServerProgram&) = delete;
    ServerProgram& operator=(const ServerProgram&) = delete;
    ~ServerProgram();

    std::string address() const { return "unix:" + folder_.file("socket"); }
    std::string file(const std::string& name) const { return folder_.file(name); }
    pid_t id() const { return id_; }
    bool lives();
    void signal(int number) const;
    /// Returns the exit status, or 128 + signal if the server was killed.
    int wait();
    /// Sends SIGKILL, and restarts the server on the same socket.
    void kill_and_restart();
    /// Returns the output of all runs of the server.
    std::string log() const { return read_file(folder_.file("log")); }
    /// Returns the resident memory in bytes, 0 if the server does not run.
    std::uint64_t memory() const;
    /// Limits further memory mappings to `more` bytes.
    void limit_memory(std::uint64_t more) const;
    /// Returns the number of open descriptors, 0 if the server does not run.
    std::size_t descriptors() const;

private:
    void start();

    TemporaryDirectory folder_;
    Setting setting_;
    pid_t id_ = 0;
};

}  // namespace octopair::test
