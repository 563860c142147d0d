#include "service/server/net/listener.hpp"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "base/descriptor.hpp"
#include "octopair/error.hpp"

namespace octopair::service {

namespace {

constexpr int backlog = 1024;
constexpr std::chrono::seconds check_interval(1);        // between checks for closed connections, and between log lines
constexpr std::chrono::milliseconds watch_interval(50);  // between checks of connections without an admitted call
constexpr std::chrono::milliseconds refusal_delay(250);  // from a refusal to its reason, and from the reason to closing
constexpr std::size_t max_refused_open = 64;             // refused connections that are not closed yet
constexpr std::size_t max_spares = 8;                    // descriptors reserved for refusing connections

void send(const Descriptor& connection, std::string_view bytes) {
    (void)::send(connection.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

// Frames of HTTP/2 (RFC 9113).
constexpr std::string_view empty_settings("\0\0\0\4\0\0\0\0\0", 9);
/// Returns a GOAWAY frame with last stream 0, error 11 (ENHANCE_YOUR_CALM) and `words` as debug data.
std::string goaway(const std::string& words) {
    const auto length = std::uint32_t(8 + words.size());
    std::string frame = {char(length >> 16), char(length >> 8), char(length), 7, 0, 0, 0, 0, 0};
    frame += std::string("\0\0\0\0\0\0\0\13", 8);
    return frame + words;
}

/// Returns whether a socket exists at the path. Throws: Error{io_failed} if another kind of file exists there.
bool socket_exists(const Address& address) {
    struct stat found {};
    if (::lstat(address.path.c_str(), &found) != 0) return false;
    if (!S_ISSOCK(found.st_mode))
        throw Error(ErrorCode::io_failed, address.text() + ": the path exists and is not a socket");
    return true;
}

[[noreturn]] void fail_unprotected(const Address& address, const std::string& unprotected) {
    throw Error(ErrorCode::usage, address.text() + ": other machines can reach it; that needs " + unprotected);
}

/// Returns the address of a listening socket. Throws: Error{usage} if it is neither of TCP nor a Unix socket with a path.
Address bound_address(const Descriptor& socket) {
    sockaddr_storage bound{};
    socklen_t size = sizeof(bound);
    if (::getsockname(socket.number(), reinterpret_cast<sockaddr*>(&bound), &size) != 0)
        fail_io("the socket", "cannot listen", errno);
    Address address;
    if (bound.ss_family == AF_UNIX) address.path = reinterpret_cast<const sockaddr_un&>(bound).sun_path;
    if (bound.ss_family == AF_INET || bound.ss_family == AF_INET6) {
        std::array<char, NI_MAXHOST> host{};
        std::array<char, NI_MAXSERV> port{};
        if (::getnameinfo(reinterpret_cast<const sockaddr*>(&bound), size, host.data(), host.size(), port.data(),
                          port.size(), NI_NUMERICHOST | NI_NUMERICSERV) == 0) {
            address.host = host.data();
            address.port = port.data();
        }
    }
    if (address.path.empty() && address.host.empty())
        throw Error(ErrorCode::usage, "the passed socket is neither of TCP nor a Unix socket with a path");
    return address;
}

}  // namespace

Listener::Listener(const Address& address, const std::shared_ptr<Descriptor>& passed, const std::string& unprotected)
    : address_(address) {
    wake_ = Descriptor(::eventfd(0, EFD_CLOEXEC));
    if (!wake_.open()) fail_io(address_.text(), "cannot listen", errno);
    if (passed)
        take_over(std::move(*passed), unprotected);
    else
        address_.is_unix() ? bind_unix() : bind_tcp(unprotected);
    if (::listen(socket_.number(), backlog) != 0) fail_io(address_.text(), "cannot listen", errno);
}

Listener::~Listener() {
    stop();
    struct stat found {};
    const bool is_own = bound_ != 0 && ::lstat(address_.path.c_str(), &found) == 0 && found.st_ino == bound_;
    if (is_own) ::unlink(address_.path.c_str());
}

/// Takes the lock file, then replaces an old socket at the path. The lock was free, so the server of the old socket has ended.
void Listener::bind_unix() {
    (void)socket_exists(address_);
    const std::string lock = address_.path + ".lock";
    lock_ = Descriptor(::open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
    if (!lock_.open()) fail_io(lock, "cannot open", errno);
    if (::flock(lock_.number(), LOCK_EX | LOCK_NB) != 0) {
        if (errno == EWOULDBLOCK) {
            throw Error(ErrorCode::io_failed, address_.text() + ": another server listens there");
        }
        fail_io(lock, "cannot lock", errno);
    }
    if (socket_exists(address_) && ::unlink(address_.path.c_str()) != 0)
        fail_io(address_.text(), "cannot replace", errno);
    socket_ = Descriptor(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    if (!socket_.open()) fail_io(address_.text(), "cannot listen", errno);
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    std::memcpy(name.sun_path, address_.path.c_str(), address_.path.size() + 1);
    // Clients cannot connect before listen(), so other users cannot connect between bind() and chmod().
    if (::bind(socket_.number(), reinterpret_cast<const sockaddr*>(&name), sizeof(name)) != 0 ||
        ::chmod(address_.path.c_str(), 0600) != 0) {
        fail_io(address_.text(), "cannot listen", errno);
    }
    struct stat found {};
    if (::lstat(address_.path.c_str(), &found) == 0) bound_ = found.st_ino;
}

void Listener::bind_tcp(const std::string& unprotected) {
    addrinfo hints{}, *list = nullptr;
    hints.ai_socktype = SOCK_STREAM;
    hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
    const int refused = ::getaddrinfo(address_.host.c_str(), address_.port.c_str(), &hints, &list);
    if (refused != 0) throw Error(ErrorCode::io_failed, address_.text() + ": " + ::gai_strerror(refused));
    const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owned(list, &::freeaddrinfo);
    for (const addrinfo* one = list; one != nullptr && !unprotected.empty(); one = one->ai_next) {
        if (is_loopback(*one->ai_addr)) continue;
        fail_unprotected(address_, unprotected);
    }
    socket_ = Descriptor(::socket(list->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    const int on = 1;
    // Without SO_REUSEPORT: a second server on the address is refused.
    if (!socket_.open() || ::setsockopt(socket_.number(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on)) != 0 ||
        ::bind(socket_.number(), list->ai_addr, list->ai_addrlen) != 0) {
        fail_io(address_.text(), "cannot listen", errno);
    }
    address_.port = bound_address(socket_).port;
}

void Listener::take_over(Descriptor passed, const std::string& unprotected) {
    socket_ = std::move(passed);
    const int flags = ::fcntl(socket_.number(), F_GETFL);
    if (flags < 0 || ::fcntl(socket_.number(), F_SETFL, flags | O_NONBLOCK) != 0 ||
        ::fcntl(socket_.number(), F_SETFD, FD_CLOEXEC) != 0) {
        fail_io("the passed socket", "cannot listen", errno);
    }
    address_ = bound_address(socket_);
    if (!address_.is_unix() && !is_this_machine(address_) && !unprotected.empty())
        fail_unprotected(address_, unprotected);
}

void Listener::start(ListenerOptions options) {
    options_ = std::move(options);
    if (!address_.is_unix())
        watch_.emplace(ConnectionLimits{.max_connections = options_.max_connections,
                                        .max_per_client = options_.max_per_client,
                                        .greeting = options_.greeting});
    thread_ = std::thread([this] { accept_connections(); });
}

void Listener::stop() {
    if (!thread_.joinable()) return;
    const std::uint64_t one = 1;
    (void)!::write(wake_.number(), &one, sizeof(one));
    thread_.join();
    socket_ = {};
}

void Listener::accept_connections() {
    const auto poll_timeout = [&] {
        if (awaits_calls()) return int(watch_interval.count());
        if (!refused_connections_.empty()) return int(refusal_delay.count());
        return accepted_.empty() ? -1 : int(std::chrono::milliseconds(check_interval).count());
    };
    std::array<pollfd, 2> watched = {{{socket_.number(), POLLIN, 0}, {wake_.number(), POLLIN, 0}}};
    for (int ready = 0; ready >= 0 || errno == EINTR;) {
        ready = ::poll(watched.data(), watched.size(), poll_timeout());
        if (ready == 0) forget_closed();
        close_refused();
        check_watched();
        if (ready <= 0) continue;
        if (watched[1].revents != 0) return;
        Descriptor connection(::accept4(socket_.number(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
        if (connection.open()) {
            take(std::move(connection));
        } else if (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM) {
            refuse_one_more();
            // Wait 20 ms for descriptors to be freed. Otherwise the client would reconnect and be refused again at once.
            std::array<pollfd, 1> ended = {{{wake_.number(), POLLIN, 0}}};
            (void)::poll(ended.data(), ended.size(), 20);
        }
    }
}

/// Refuses one connection when the process has no descriptors left, with a spare descriptor. Without a spare, the connection waits.
void Listener::refuse_one_more() {
    if (spares_.empty()) return;
    spares_.pop_back();
    Descriptor connection(::accept4(socket_.number(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (connection.open() && is_ours(connection)) {
        refuse(std::move(connection), "no more descriptors for connections");
    } else {
        connection = {};
        refill_spares();
    }
}

void Listener::refill_spares() {
    while (spares_.size() < max_spares) {
        Descriptor spare(::open("/dev/null", O_RDONLY | O_CLOEXEC));
        if (!spare.open()) return;
        spares_.push_back(std::move(spare));
    }
}

void Listener::take(Descriptor connection) {
    if (!is_ours(connection)) return;
    const std::uint64_t most = options_.max_connections;
    const auto is_full = [&] { return most > 0 && accepted_.size() + waiting_ >= most; };
    if (accepted_.size() >= forget_from_ || is_full()) forget_closed();
    if (is_full()) {
        refuse(std::move(connection), "at most " + std::to_string(most) + " connections");
        return;
    }
    refill_spares();
    if (!address_.is_unix()) {
        const int on = 1;
        (void)::setsockopt(connection.number(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
    }
    if (watch_) {
        watch(std::move(connection));
    } else {
        hand_on(std::move(connection));
    }
}

/// Watches a TCP connection until the server admits the first call on this connection.
void Listener::watch(Descriptor connection) {
    const auto peer = peer_of(connection);
    if (!peer) return;  // the connection has ended
    {
        const std::lock_guard lock(watch_mutex_);
        watch_->add(std::move(connection), *peer, ConnectionWatch::Clock::now());
    }
    hand_on_ready();
}

/// Passes the connections whose wait is over (ConnectionWatch) to gRPC.
void Listener::hand_on_ready() {
    std::vector<Descriptor> ready;
    {
        const std::lock_guard lock(watch_mutex_);
        ready = watch_->take_ready(ConnectionWatch::Clock::now());
        unknown_ = watch_->unknown();
        waiting_ = watch_->waiting();
    }
    for (Descriptor& connection : ready) hand_on(std::move(connection));
}

void Listener::hand_on(Descriptor connection) {
    report_process(connection);
    accepted_.push_back({connection.number(), socket_of(connection.number())});
    connections_ = accepted_.size();
    options_.accept(std::move(connection));
}

ConnectionWatch::Admission Listener::make_known(const std::string& peer, const ConnectionWatch::Client& client) {
    if (!watch_) return ConnectionWatch::Admission::known_before;
    const std::lock_guard lock(watch_mutex_);
    const auto admission = watch_->make_known(peer, client, ConnectionWatch::Clock::now());
    unknown_ = watch_->unknown();
    return admission;
}

void Listener::note_refused(const std::string& peer) {
    if (!watch_) return;
    const std::lock_guard lock(watch_mutex_);
    watch_->note_refused(peer, ConnectionWatch::Clock::now());
    unknown_ = watch_->unknown();
}

bool Listener::note_begin(std::uint64_t number) {
    const std::lock_guard lock(watch_mutex_);
    return !watch_ || watch_->note_begin(number, ConnectionWatch::Clock::now());
}

void Listener::note_end(std::uint64_t number, bool reset) {
    const std::lock_guard lock(watch_mutex_);
    if (watch_) watch_->note_end(number, reset, ConnectionWatch::Clock::now());
}

void Listener::check_watched() {
    if (!watch_ || !awaits_calls()) return;
    std::uint64_t cut = 0;
    {
        const std::lock_guard lock(watch_mutex_);
        cut = watch_->check(ConnectionWatch::Clock::now());
    }
    hand_on_ready();
    if (cut == 0) return;
    refused_ += cut;
    report_refusals();
}

void Listener::report_refusals() {
    const auto now = std::chrono::steady_clock::now();
    if (!options_.refused || now - last_report_ < check_interval) return;
    last_report_ = now;
    options_.refused();
}

/// Returns whether the peer may connect. On a Unix socket the peer must be the user that runs the server, or root.
bool Listener::is_ours(const Descriptor& connection) const {
    if (!address_.is_unix()) return true;
    ucred peer{};
    socklen_t size = sizeof(peer);
    return ::getsockopt(connection.number(), SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0 &&
           (peer.uid == ::geteuid() || peer.uid == 0);
}

void Listener::report_process(const Descriptor& connection) const {
    if (!address_.is_unix() || !options_.connected) return;
    ucred peer{};
    socklen_t size = sizeof(peer);
    if (::getsockopt(connection.number(), SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) return;
    options_.connected("unix:user=" + std::to_string(peer.uid) + ",process=" + std::to_string(peer.pid));
}

/// Removes closed connections from the list. gRPC does not report closing, so the inodes of the descriptors are compared.
void Listener::forget_closed() {
    std::erase_if(accepted_, [](const Accepted& known) { return socket_of(known.number) != known.socket; });
    connections_ = accepted_.size();
    forget_from_ = std::max<std::size_t>(64, 2 * accepted_.size());
}

void Listener::refuse(Descriptor connection, std::string why) {
    ++refused_;
    report_refusals();
    const auto now = std::chrono::steady_clock::now();
    if (!options_.encrypted) send(connection, empty_settings);
    refused_connections_.push_back({std::move(connection), std::move(why), now});
    if (refused_connections_.size() > max_refused_open) {
        send_refusal(refused_connections_.front());
        refused_connections_.pop_front();
    }
}

void Listener::send_refusal(Refused& refused) const {
    if (std::exchange(refused.reason_sent, true)) return;
    // Read what the client has sent so far. Closing with unread data would reset the connection, and the client would lose the reason.
    std::array<char, 1 << 16> said;
    (void)::recv(refused.connection.number(), said.data(), said.size(), MSG_DONTWAIT);
    if (!options_.encrypted) send(refused.connection, goaway("octopair: " + refused.why));
    (void)::shutdown(refused.connection.number(), SHUT_WR);
}

void Listener::close_refused() {
    const auto now = std::chrono::steady_clock::now();
    for (Refused& refused : refused_connections_) {
        if (now - refused.since >= refusal_delay) send_refusal(refused);
    }
    while (!refused_connections_.empty() && now - refused_connections_.front().since >= 2 * refusal_delay) {
        refused_connections_.pop_front();
        refill_spares();
    }
}

}  // namespace octopair::service
