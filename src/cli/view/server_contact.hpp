// ServerContact: makes the calls of `octopair view` to a server. Sends a message to the pages when the server stops answering, and when
// it answers again.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>

#include "octopair/error.hpp"
#include "viewer/scene/source.hpp"
#include "viewer/server/page_server.hpp"

namespace octopair::cli {

/// Waits until a stop request, at most `most`. Returns whether a stop was requested.
inline bool pause(const std::stop_token& stop, std::chrono::milliseconds most) {
    std::mutex mutex;
    std::condition_variable_any wake;
    std::unique_lock lock(mutex);
    wake.wait_for(lock, stop, most, [] { return false; });
    return stop.stop_requested();
}

/// Returns what `call` returns. `call` gets a stop token. Throws: what `call` throws; Error{engine_failed} if it takes more than
/// 10 seconds.
template <typename Call>
auto within_time(const std::stop_token& stop, const Call& call) {
    constexpr std::chrono::seconds most(10);
    std::stop_source ends;
    const std::stop_callback outer(stop, [&] { ends.request_stop(); });
    std::atomic<bool> late = false;
    const std::jthread timer([&](const std::stop_token& done) {
        if (pause(done, most)) return;
        late = true;
        ends.request_stop();
    });
    try {
        return call(ends.get_token());
    } catch (const Error&) {
        if (!late) throw;
        throw Error(ErrorCode::engine_failed, "the server has not answered for " + std::to_string(most.count()) + " s");
    }
}

/// Sends messages about the state of the connection to the pages of a path (page_server.hpp).
class ServerContact {
public:
    explicit ServerContact(std::string path) : path_(std::move(path)) {}

    /// Returns what `call` returns. `call` gets a stop token. If the server does not answer, sends a message to the pages, pauses, and
    /// returns nothing.
    /// Throws: what `call` throws for other reasons.
    template <typename Call>
    std::invoke_result_t<Call, std::stop_token> ask(viewer::PageServer& server, const std::stop_token& stop,
                                                    const Call& call) {
        try {
            auto answer = within_time(stop, call);
            if (std::exchange(lost_, false)) server.broadcast(path_, viewer::ready_message());
            return answer;
        } catch (const Error& error) {
            if (error.code() != ErrorCode::engine_failed || stop.stop_requested()) throw;
            lost_ = true;
            server.broadcast(path_, viewer::waiting_message(error.what()));
            pause(stop, std::chrono::milliseconds(500));
            return {};
        }
    }

private:
    std::string path_;
    bool lost_ = false;  // true if the server did not answer the last call
};

}  // namespace octopair::cli
