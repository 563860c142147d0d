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

#include "base/io_failure.hpp"
#include "octopair/error.hpp"

namespace octopair::service {

namespace {

constexpr int backlog = 1024;
constexpr std::chrono::seconds check_interval(1);  // looks for what was closed, and words about refusals
constexpr std::chrono::milliseconds leave(250);    // until a refused connection is told why, and until it is closed
constexpr std::size_t most_leaving = 64;           // refused connections at once
constexpr std::size_t most_spares = 8;             // descriptors kept to refuse with

ino_t socket_of(int descriptor) {
    struct stat found {};
    return ::fstat(descriptor, &found) == 0 && S_ISSOCK(found.st_mode) ? found.st_ino : 0;
}

void send(const Descriptor& connection, std::string_view bytes) {
    (void)::send(connection.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

// HTTP/2 (RFC 9113)
constexpr std::string_view empty_settings("\0\0\0\4\0\0\0\0\0", 9);
/// GOAWAY for no stream, with error 11, "enhance your calm", and words.
std::string goaway(const std::string& words) {
    const auto length = std::uint32_t(8 + words.size());
    std::string frame = {char(length >> 16), char(length >> 8), char(length), 7, 0, 0, 0, 0, 0};
    frame += std::string("\0\0\0\0\0\0\0\13", 8);
    return frame + words;
}

/// Whether there is a socket. Throws Error{io_failed} for what is none.
bool is_there(const Address& address) {
    struct stat found {};
    if (::lstat(address.path.c_str(), &found) != 0) return false;
    if (!S_ISSOCK(found.st_mode)) throw Error(ErrorCode::io_failed, address.text() + ": there is a file already");
    return true;
}

}  // namespace

Listener::Listener(const Address& address, const std::string& unprotected) : address_(address) {
    wake_ = Descriptor(::eventfd(0, EFD_CLOEXEC));
    if (!wake_.open()) fail_io(address_.text(), "cannot listen", errno);
    address_.is_unix() ? bind_unix() : bind_tcp(unprotected);
    if (::listen(socket_.number(), backlog) != 0) fail_io(address_.text(), "cannot listen", errno);
}

Listener::~Listener() {
    stop();
    if (address_.is_unix()) ::unlink(address_.path.c_str());
}

/// Whoever holds the lock may take away a socket at the path: its server is dead.
void Listener::bind_unix() {
    (void)is_there(address_);
    const std::string lock = address_.path + ".lock";
    lock_ = Descriptor(::open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
    if (!lock_.open()) fail_io(lock, "cannot open", errno);
    if (::flock(lock_.number(), LOCK_EX | LOCK_NB) != 0) {
        if (errno == EWOULDBLOCK) {
            throw Error(ErrorCode::io_failed, address_.text() + ": another server listens there");
        }
        fail_io(lock, "cannot lock", errno);
    }
    if (is_there(address_) && ::unlink(address_.path.c_str()) != 0) fail_io(address_.text(), "cannot replace", errno);
    socket_ = Descriptor(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    if (!socket_.open()) fail_io(address_.text(), "cannot listen", errno);
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    std::memcpy(name.sun_path, address_.path.c_str(), address_.path.size() + 1);
    // Nobody can connect before listen(), so there is no moment at which others may.
    if (::bind(socket_.number(), reinterpret_cast<const sockaddr*>(&name), sizeof(name)) != 0 ||
        ::chmod(address_.path.c_str(), 0600) != 0) {
        fail_io(address_.text(), "cannot listen", errno);
    }
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
        throw Error(ErrorCode::usage, address_.text() + ": other machines can reach it; that needs " + unprotected);
    }
    socket_ = Descriptor(::socket(list->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    const int on = 1;
    // Without SO_REUSEPORT: a second server on the address is refused.
    if (!socket_.open() || ::setsockopt(socket_.number(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on)) != 0 ||
        ::bind(socket_.number(), list->ai_addr, list->ai_addrlen) != 0) {
        fail_io(address_.text(), "cannot listen", errno);
    }
    sockaddr_storage bound{};
    socklen_t size = sizeof(bound);
    if (::getsockname(socket_.number(), reinterpret_cast<sockaddr*>(&bound), &size) != 0) {
        fail_io(address_.text(), "cannot listen", errno);
    }
    const bool six = bound.ss_family == AF_INET6;
    address_.port = std::to_string(ntohs(six ? reinterpret_cast<const sockaddr_in6&>(bound).sin6_port
                                             : reinterpret_cast<const sockaddr_in&>(bound).sin_port));
}

void Listener::start(Terms terms) {
    terms_ = std::move(terms);
    thread_ = std::thread([this] { take_connections(); });
}

void Listener::stop() {
    if (!thread_.joinable()) return;
    const std::uint64_t one = 1;
    (void)!::write(wake_.number(), &one, sizeof(one));
    thread_.join();
    socket_ = {};
}

void Listener::take_connections() {
    const auto look = [&] {
        if (!leaving_.empty()) return int(leave.count());
        return known_.empty() ? -1 : int(std::chrono::milliseconds(check_interval).count());
    };
    std::array<pollfd, 2> watched = {{{socket_.number(), POLLIN, 0}, {wake_.number(), POLLIN, 0}}};
    for (int ready = 0; ready >= 0 || errno == EINTR;) {
        ready = ::poll(watched.data(), watched.size(), look());
        if (ready == 0) forget_closed();
        see_out_refused();
        if (ready <= 0) continue;
        if (watched[1].revents != 0) return;
        Descriptor connection(::accept4(socket_.number(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
        if (connection.open()) {
            take(std::move(connection));
        } else if (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM) {
            refuse_one_more();
            // Until others have closed theirs: it would be refused again at once.
            std::array<pollfd, 1> ended = {{{wake_.number(), POLLIN, 0}}};
            (void)::poll(ended.data(), ended.size(), 20);
        }
    }
}

/// There are no more descriptors for connections. While all spare ones are used for this, those who wish to connect wait.
void Listener::refuse_one_more() {
    if (spares_.empty()) return;
    spares_.pop_back();
    Descriptor connection(::accept4(socket_.number(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (connection.open() && is_ours(connection)) {
        refuse(std::move(connection), "no more descriptors for connections");
    } else {
        connection = {};
        take_spares();
    }
}

void Listener::take_spares() {
    while (spares_.size() < most_spares) {
        Descriptor spare(::open("/dev/null", O_RDONLY | O_CLOEXEC));
        if (!spare.open()) return;
        spares_.push_back(std::move(spare));
    }
}

void Listener::take(Descriptor connection) {
    if (!is_ours(connection)) return;
    const std::uint64_t most = terms_.most_connections;
    if (known_.size() >= forget_from_ || (most > 0 && known_.size() >= most)) forget_closed();
    if (most > 0 && known_.size() >= most) {
        refuse(std::move(connection), "at most " + std::to_string(most) + " connections");
        return;
    }
    take_spares();
    if (!address_.is_unix()) {
        const int on = 1;
        (void)::setsockopt(connection.number(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
    }
    known_.push_back({connection.number(), socket_of(connection.number())});
    connections_ = known_.size();
    terms_.accept(std::move(connection));
}

/// At a Unix socket, the user that runs the server, or the one who may all.
bool Listener::is_ours(const Descriptor& connection) const {
    if (!address_.is_unix()) return true;
    ucred peer{};
    socklen_t size = sizeof(peer);
    return ::getsockopt(connection.number(), SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0 &&
           (peer.uid == ::geteuid() || peer.uid == 0);
}

/// gRPC does not say when it closes a connection; the system knows.
void Listener::forget_closed() {
    std::erase_if(known_, [](const Known& known) { return socket_of(known.number) != known.socket; });
    connections_ = known_.size();
    forget_from_ = std::max<std::size_t>(64, 2 * known_.size());
}

void Listener::refuse(Descriptor connection, std::string why) {
    ++refused_;
    const auto now = std::chrono::steady_clock::now();
    if (terms_.refused && now - told_ >= check_interval) {
        told_ = now;
        terms_.refused();
    }
    if (!terms_.encrypted) send(connection, empty_settings);
    leaving_.push_back({std::move(connection), std::move(why), now});
    if (leaving_.size() > most_leaving) {
        see_out(leaving_.front());
        leaving_.pop_front();
    }
}

void Listener::see_out(Refused& refused) const {
    if (std::exchange(refused.told, true)) return;
    // What is unread when it is closed would reset the connection, and the words with it. gRPC's greeting is short.
    std::array<char, 1 << 16> said;
    (void)::recv(refused.connection.number(), said.data(), said.size(), MSG_DONTWAIT);
    if (!terms_.encrypted) send(refused.connection, goaway("octopair: " + refused.why));
    (void)::shutdown(refused.connection.number(), SHUT_WR);
}

void Listener::see_out_refused() {
    const auto now = std::chrono::steady_clock::now();
    for (Refused& refused : leaving_) {
        if (now - refused.since >= leave) see_out(refused);
    }
    while (!leaving_.empty() && now - leaving_.front().since >= 2 * leave) {
        leaving_.pop_front();
        take_spares();
    }
}

}  // namespace octopair::service
