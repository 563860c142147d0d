#include "viewer/server/page_server.hpp"

#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <cerrno>
#include <chrono>
#include <future>
#include <map>
#include <set>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "octopair/error.hpp"
#include "viewer/scene/source.hpp"
#include "viewer/server/connection.hpp"

namespace octopair::viewer {

namespace {

namespace asio = boost::asio;
using Tcp = asio::ip::tcp;
using namespace std::chrono_literals;

/// Lets the threads of other programs, and other threads of this program, run first.
void lower_priority() { ::setpriority(PRIO_PROCESS, 0, 19); }

Tcp::endpoint endpoint_of(const PageServerOptions& options) {
    boost::system::error_code error;
    const asio::ip::address address = asio::ip::make_address(options.host, error);
    if (error) throw Error(ErrorCode::usage, "host '" + options.host + "': not a numeric address, such as 127.0.0.1");
    return {address, options.port};
}

}  // namespace

class PageServer::Impl final : public ConnectionHost {
public:
    Impl(Source& source, const PageServerOptions& options)
        : source_(source), options_(options), acceptor_(io_), access_(options.host, open(options), options.token) {}

    void start() {
        accept();
        thread_ = std::thread([this] {
            if (options_.low_priority) lower_priority();
            run_connections();
        });
        if (options_.low_priority) asio::post(pool_, lower_priority);
    }

    void stop() {
        stopping_ = true;
        const auto latest = Clock::now() + 500ms;
        std::promise<void> done;
        asio::post(io_, [&] {
            acceptor_.close();
            pause_.cancel();
            frame_timer_.cancel();
            try {
                for (WebSocket* socket : sockets()) socket->send(closed_message());
            } catch (const std::bad_alloc&) {  // the pages see that the connection ends
            }
            done.set_value();
        });
        done.get_future().wait();
        // Each call of busy() waits for the connections' thread. With low priority on a busy machine this thread runs seldom, so poll only
        // until `latest`.
        while (Clock::now() < latest && busy()) std::this_thread::sleep_for(10ms);
        pool_.stop();
        pool_.join();
        io_.stop();
        thread_.join();
    }

    std::string address() const {
        const std::string host =
            options_.host.find(':') == std::string::npos ? options_.host : '[' + options_.host + ']';
        const std::string query = options_.token.empty() ? "" : "?token=" + options_.token;
        return "http://" + host + ':' + std::to_string(port_) + '/' + query;
    }

    void notify() {
        if (notified_.exchange(true)) return;
        try {
            asio::post(io_, [this] {
                notified_ = false;
                offer_frames();
            });
        } catch (...) {
            notified_ = false;
            throw;
        }
    }

    void broadcast(const std::string& path, std::string message) {
        asio::post(io_, [this, path, text = std::move(message)] {
            for (WebSocket* socket : sockets()) {
                if (socket->path() == path) socket->send(text);
            }
        });
    }

    // ConnectionHost
    Source& source() override { return source_; }
    const Access& access() const override { return access_; }
    void compute(std::function<void()> work) override { asio::post(pool_, std::move(work)); }
    void opened() override { ++connections_; }
    void closed() override { --connections_; }
    void came(Stranger& stranger) override {
        if (strangers_.size() >= max_strangers) cut_stranger();
        strangers_.push_back(&stranger);
    }
    void went(Stranger& stranger) override { std::erase(strangers_, &stranger); }
    void joined(WebSocket& socket) override {
        sockets_.insert(&socket);
        source_.connected(socket.path(), true);
    }
    void left(WebSocket& socket) override {
        sockets_.erase(&socket);
        source_.connected(socket.path(), false);
    }

    bool may_send_frame() override {
        if (stopping_) return false;  // making another frame would delay the destructor
        const auto now = Clock::now();
        if (!options_.low_priority || now >= next_frame_) return true;
        if (!std::exchange(frame_timer_runs_, true)) {
            frame_timer_.expires_at(next_frame_);
            frame_timer_.async_wait([this](boost::system::error_code error) {
                frame_timer_runs_ = false;
                if (!error) offer_frames();
            });
        }
        return false;
    }
    std::uint64_t take_turn(std::size_t bytes) override {
        const std::chrono::duration<double> pause(double(bytes) / max_frame_bytes_per_second);
        next_frame_ = std::max(Clock::now(), next_frame_) + std::chrono::duration_cast<Clock::duration>(pause);
        return ++turns_;
    }

private:
    using Clock = std::chrono::steady_clock;

    /// Offers the latest frame to all pages, first to those that have waited longest.
    void offer_frames() {
        std::vector<WebSocket*> waiting = sockets();
        std::stable_sort(waiting.begin(), waiting.end(),
                         [](const WebSocket* x, const WebSocket* y) { return x->last_turn() < y->last_turn(); });
        for (WebSocket* socket : waiting) {
            if (!may_send_frame()) return;
            socket->offer_frame();
        }
    }

    /// Cuts the oldest stranger of the address that has most of them.
    void cut_stranger() {
        std::map<std::string_view, std::size_t> counts;
        for (const Stranger* stranger : strangers_) ++counts[stranger->address()];
        const auto most = std::max_element(counts.begin(), counts.end(),
                                           [](const auto& x, const auto& y) { return x.second < y.second; });
        const auto oldest = std::find_if(strangers_.begin(), strangers_.end(), [&](const Stranger* one) {
            return counts.at(one->address()) == most->second;
        });
        Stranger& cut = **oldest;
        strangers_.erase(oldest);
        cut.cut();
    }

    /// Serves connections until stop(). A connection for which the memory does not suffice ends.
    void run_connections() {
        for (;;) {
            try {
                io_.run();
                return;
            } catch (const std::exception&) {  // a lack of memory or of threads
            }
        }
    }

    // Programs that the user's program starts must not inherit sockets: they would keep connections open. Asio has no option for that, so
    // these functions open and accept sockets themselves.
    static constexpr int socket_flags = SOCK_CLOEXEC | SOCK_NONBLOCK;

    std::uint16_t open(const PageServerOptions& options) {
        const Tcp::endpoint endpoint = endpoint_of(options);
        boost::system::error_code error;
        const int socket = ::socket(endpoint.protocol().family(), SOCK_STREAM | socket_flags, 0);
        if (socket < 0) error.assign(errno, boost::system::system_category());
        if (!error) acceptor_.assign(endpoint.protocol(), socket, error);
        if (error && socket >= 0) ::close(socket);
        if (!error) acceptor_.set_option(asio::socket_base::reuse_address(true), error);
        if (!error) acceptor_.bind(endpoint, error);
        if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
        if (error) {
            throw Error(ErrorCode::io_failed, "cannot listen on " + options.host + ':' + std::to_string(options.port) +
                                                  ": " + error.message() + "; choose another port, or 0 for any");
        }
        port_ = acceptor_.local_endpoint().port();
        return port_;
    }

    void accept() {
        acceptor_.async_wait(Tcp::acceptor::wait_read, [this](boost::system::error_code error) {
            if (error == asio::error::operation_aborted || !acceptor_.is_open()) return;
            if (error || !accept_waiting()) return accept_later();
            accept();
        });
    }

    /// Accepts connections that wait, but few at a time: the requests of these must be read before later connections cut them. Returns
    /// false if one cannot be accepted, for example because the process has too many open files.
    bool accept_waiting() {
        constexpr int max_at_once = 16;
        for (int i = 0; i < max_at_once; ++i) {
            const int connection = ::accept4(acceptor_.native_handle(), nullptr, nullptr, socket_flags);
            if (connection < 0) {
                if (errno == EINTR || errno == ECONNABORTED) continue;
                return errno == EAGAIN;
            }
            boost::system::error_code error;
            Tcp::socket socket(io_);
            socket.assign(endpoint_of(options_).protocol(), connection, error);
            if (error) {
                ::close(connection);
                return false;
            }
            if (accepts(socket)) serve_connection(std::move(socket), *this);
        }
        return true;
    }

    /// Waits before the next connection is accepted.
    void accept_later() {
        pause_.expires_after(100ms);
        pause_.async_wait([this](boost::system::error_code) {
            if (acceptor_.is_open()) accept();
        });
    }

    /// Without a token, other users of this machine are refused.
    bool accepts(const Tcp::socket& socket) const {
        if (connections_ >= max_connections) return false;
        boost::system::error_code error;
        const Tcp::endpoint peer = socket.remote_endpoint(error);
        if (error) return false;
        const Tcp::endpoint here = socket.local_endpoint(error);
        return !options_.token.empty() ||
               (!error && peer.address().is_loopback() &&
                is_own_user({peer.address().to_string(), peer.port()}, {here.address().to_string(), here.port()}));
    }

    /// Returns the pages. The list may change while it is used, because a message may end a connection.
    std::vector<WebSocket*> sockets() const { return {sockets_.begin(), sockets_.end()}; }
    bool busy() {
        std::promise<bool> answer;
        asio::post(io_, [&] {
            bool any = false;
            for (const WebSocket* socket : sockets_) any |= socket->is_sending();
            answer.set_value(any);
        });
        return answer.get_future().get();
    }

    static constexpr unsigned max_connections = 256;
    static constexpr std::size_t max_strangers = 64;
    /// Limit for all pages together, on a server with low priority. Without it, 50 pages made steps of a scene of 100,000 boxes 20% slower.
    static constexpr double max_frame_bytes_per_second = 50e6;

    Source& source_;
    PageServerOptions options_;
    std::set<WebSocket*> sockets_;
    std::vector<Stranger*> strangers_;  // oldest first
    std::atomic<unsigned> connections_ = 0;
    // Connections that are still open are destroyed with io_, and use the members above. Handlers that have not run are
    // destroyed with io_, too, so they must not own this object.
    asio::io_context io_{1};
    // stop() still uses the thread of the connections after the last connection has ended.
    asio::executor_work_guard<asio::io_context::executor_type> work_ = asio::make_work_guard(io_);
    asio::thread_pool pool_{1};
    Tcp::acceptor acceptor_;
    asio::steady_timer pause_{io_}, frame_timer_{io_};
    bool frame_timer_runs_ = false;
    Clock::time_point next_frame_ = {};  // earliest time of the next live frame
    std::uint64_t turns_ = 0;
    std::uint16_t port_ = 0;
    Access access_;
    std::atomic<bool> notified_ = false, stopping_ = false;
    std::thread thread_;
};

PageServer::PageServer(Source& source, const PageServerOptions& options)
    : impl_(std::make_unique<Impl>(source, options)) {
    impl_->start();
}

PageServer::~PageServer() { impl_->stop(); }

std::string PageServer::address() const { return impl_->address(); }
void PageServer::notify() { impl_->notify(); }
void PageServer::broadcast(const std::string& path, std::string message) { impl_->broadcast(path, std::move(message)); }

}  // namespace octopair::viewer
