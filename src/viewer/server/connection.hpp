// Connections of a page server: requests by HTTP, and WebSockets.
//
// A connection exists until its last pending operation has ended. All of its code runs on the thread of the host's io_context, except
// the work of ConnectionHost::compute().
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <cstdint>
#include <functional>
#include <string>

#include "viewer/scene/source.hpp"
#include "viewer/server/access.hpp"

namespace octopair::viewer {

/// A page that is connected by WebSocket.
class WebSocket {
public:
    virtual ~WebSocket() = default;
    /// Path below which the page gets its data: empty, or for example "scene/7".
    virtual const std::string& path() const = 0;
    /// Sends a message (JSON). A page that does not read loses messages.
    virtual void send(std::string message) = 0;
    /// Sends a live frame if the page waits for one and there is a newer one.
    virtual void offer_frame() = 0;
    virtual bool is_sending() const = 0;
    /// Returns ConnectionHost::take_turn() of the last frame that was sent; 0 if none was.
    virtual std::uint64_t last_turn() const = 0;
};

/// A connection without an answered request yet: the client may be an attacker.
class Stranger {
public:
    virtual ~Stranger() = default;
    /// Returns the address of the client, without the port.
    virtual const std::string& address() const = 0;
    /// Ends the connection.
    virtual void cut() = 0;
};

/// Services of the server for its connections. Outlives them.
class ConnectionHost {
public:
    virtual ~ConnectionHost() = default;
    virtual Source& source() = 0;
    virtual const Access& access() const = 0;
    /// Runs `work` on the thread that computes answers.
    virtual void compute(std::function<void()> work) = 0;
    virtual void opened() = 0;
    virtual void closed() = 0;
    virtual void came(Stranger& stranger) = 0;
    /// Called when the connection of the stranger has ended, or has its first answered request.
    virtual void went(Stranger& stranger) = 0;
    virtual void joined(WebSocket& socket) = 0;
    virtual void left(WebSocket& socket) = 0;
    /// Returns whether a live frame may be sent now. If not, the host calls WebSocket::offer_frame() later.
    virtual bool may_send_frame() = 0;
    /// Counts a live frame of `bytes` that is sent now. Returns a number that increases from frame to frame.
    virtual std::uint64_t take_turn(std::size_t bytes) = 0;
};

/// Serves a connection until it ends.
void serve_connection(boost::asio::ip::tcp::socket socket, ConnectionHost& host);

}  // namespace octopair::viewer
