// BrowserPipe: a browser without a window, controlled by the DevTools protocol over a pair of pipes.
//
// A message is JSON that ends with a zero byte. The browser reads commands from descriptor 3, and writes answers to descriptor 4.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <stop_token>
#include <string>
#include <vector>

#include "base/descriptor.hpp"

namespace octopair::cli {

class BrowserPipe {
public:
    /// Starts a browser with these words of a command line, in a process group of its own.
    /// Throws: Error{io_failed}.
    BrowserPipe(std::vector<std::string> words, std::stop_token stop);
    BrowserPipe(const BrowserPipe&) = delete;
    BrowserPipe& operator=(const BrowserPipe&) = delete;
    /// Kills the browser and its processes.
    ~BrowserPipe();

    /// Sends a command, and returns the result of its answer. Commands go to `session`, or to the browser if it is empty.
    /// Throws: Error{io_failed} if the browser ends, refuses, or does not answer within 60 s; Error{cancelled} soon after a stop
    /// request.
    nlohmann::json call(const std::string& method, const nlohmann::json& parameters, const std::string& session = {});

private:
    void send(const std::string& message);
    std::string receive(std::chrono::steady_clock::time_point end);

    std::stop_token stop_;
    Descriptor to_, from_;
    pid_t browser_ = -1;
    unsigned calls_ = 0;
    std::string received_;  // bytes after the last whole message
};

}  // namespace octopair::cli
