// Gate: an engine for a server under test that waits in every call until it is let go on, and says how many are there.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>

#include "octopair/octopair.hpp"
#include "service/server/server_options.hpp"

namespace octopair::test {

/// Must outlive the engines that wait at it.
class Gate {
public:
    void open();
    void close();
    /// Throws Error{cancelled} if stopped meanwhile.
    void pass(const std::stop_token& stop);
    /// Waits until so many calls are at the gate, a minute at most.
    bool wait_for(unsigned waiting);

private:
    std::mutex mutex_;
    std::condition_variable_any changed_;
    bool open_ = false;
    unsigned waiting_ = 0;
};

/// Makes local engines of one thread behind the gate.
service::EngineMaker gated_engines(Gate& gate);

}  // namespace octopair::test
