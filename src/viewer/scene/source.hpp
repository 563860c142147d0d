// Source: interface to the data that a page server serves. A page server has one source.
//
// Threads   get() is called by one thread at a time; live_frame() and greeting() by the thread of the connections.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "viewer/scene/answer.hpp"

namespace octopair::viewer {

/// A live frame that is sent to several pages.
using Message = std::shared_ptr<const std::string>;

class Source {
public:
    virtual ~Source() = default;

    /// Returns the data at an address; nothing if there are none. May take long.
    /// Throws: Error{bad_input} for parameters that make no sense; other Errors if the work fails.
    virtual std::optional<Answer> get(const Address& address) = 0;
    /// Returns the messages (JSON) that a page gets when it connects to the WebSocket at `path`, for example its progress.
    virtual std::vector<std::string> greeting(const std::string& path) = 0;
    /// Returns a live frame newer than `last` (-1: any); null if there is none yet. Must be fast.
    virtual Message live_frame(const std::string& path, std::int64_t last) = 0;
    /// Called when a page has connected to the WebSocket at `path` (`here`), and when this connection has ended.
    virtual void connected(const std::string& /*path*/, bool /*here*/) {}
    /// Returns whether the data cannot be read yet.
    virtual bool loading() const { return false; }
};

}  // namespace octopair::viewer
