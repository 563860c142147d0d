// Gate: a test engine for servers. Every call waits at the gate until the test opens it. The gate counts the waiting
// calls.
#pragma once

#include <condition_variable>
#include <mutex>
#include <string>

#include "octopair/octopair.hpp"
#include "service/server/server_options.hpp"

namespace octopair::test {

/// Blocks the calls of its engines. Must outlive these engines.
class Gate {
public:
    void open();
    void close();
    /// Lets all later calls throw Error{engine_failed} with this message.
    void fail(const std::string& message);
    /// Waits until the gate opens. Throws: Error{cancelled} if `stop` is requested before.
    void pass(const std::stop_token& stop);
    /// Waits until `waiting` calls are at the gate, for a minute at most. Returns false if the minute ended first.
    bool wait_for(unsigned waiting);

private:
    std::mutex mutex_;
    std::condition_variable_any changed_;
    bool open_ = false;
    std::string failure_;
    unsigned waiting_ = 0;
};

/// Returns a maker of local engines of one thread behind the gate. Calls with fewer objects than `free_below` pass at once.
service::EngineMaker gated_engines(Gate& gate, std::size_t free_below = 0);

}  // namespace octopair::test
