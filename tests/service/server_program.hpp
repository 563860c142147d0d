// `octopair serve` as a program of its own: to be killed, stopped, and started again.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>
#include <vector>

#include "io/temporary.hpp"

namespace octopair::test {

class ServerProgram {
public:
    struct Setting {
        std::string arguments = "--engine local --threads 2";
        std::string before = {};       ///< of the command in sh: "ulimit -n 40;"
        std::string environment = {};  ///< "NAME=VALUE ..."
    };

    /// Starts it on a Unix socket in a folder of its own.
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
    /// What it exited with, 128 + signal if it was killed.
    int wait();
    /// kill -9, and again from the beginning on the same socket.
    void kill_and_restart();
    /// What it wrote, of all its lives.
    std::string log() const { return test::read_file(folder_.file("log")); }
    /// Resident memory in bytes, and open descriptors; 0 if it does not live.
    std::uint64_t memory() const;
    /// From now on it may map no more than so many bytes beyond what it has mapped.
    void limit_memory(std::uint64_t more) const;
    std::size_t descriptors() const;

private:
    void start();

    test::TemporaryDirectory folder_;
    Setting setting_;
    pid_t id_ = 0;
};

}  // namespace octopair::test
