// PageServer: serves the page of the viewer and the data of a source (viewer/protocol.md), by HTTP and WebSocket.
//
// Access    Only requests with the server's own address in `Host`, and in `Origin` if they have one, are answered. With a token,
//           requests also need the token: as a parameter, which becomes a cookie, or as "Authorization: Bearer". Without a token,
//           only connections of this user and of root are accepted.
// Strangers A refused request ends its connection. At most 64 of 256 connections may be without an answered request: beyond that, the
//           oldest of the address that has most of them is cut. So strangers do not keep the owner out.
// Limits    Requests have no body, at most 16 KiB of header, and 30 s to arrive (the first one 5 s). A message of a page has at most 1 KiB.
// Pace      A page gets a live frame when it requests one. So no frames queue up for a page that is slow.
// Threads   Two of its own: one for connections, one that computes answers. notify() and broadcast() may be called by any thread.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "viewer/scene/source.hpp"

namespace octopair::viewer {

struct PageServerOptions {
    std::string host = "127.0.0.1";  ///< address to listen on
    std::uint16_t port = 0;          ///< 0: any free port
    std::string token = {};          ///< token that requests must have; empty: none
    bool low_priority = false;       ///< true: the server's threads have the lowest priority of the system
};

class PageServer {
public:
    /// Starts to serve. `source` is borrowed.
    /// Throws: Error{usage} for a host that is not a numeric address; Error{io_failed} if it cannot listen there.
    PageServer(Source& source, const PageServerOptions& options);
    PageServer(const PageServer&) = delete;
    PageServer& operator=(const PageServer&) = delete;
    /// Sends a last message to all pages, and ends.
    ~PageServer();

    /// Returns the address for the browser, with the token if there is one.
    std::string address() const;
    /// Sends newer live frames to the pages that wait for one.
    void notify();
    /// Sends a message to all pages that are connected to the WebSocket at `path`.
    void broadcast(const std::string& path, std::string message);

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace octopair::viewer
