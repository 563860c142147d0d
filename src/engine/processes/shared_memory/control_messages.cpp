#include "engine/processes/shared_memory/control_messages.hpp"

#include <sys/socket.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "octopair/error.hpp"

namespace octopair {

SocketPair make_socket_pair() {
    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) {
        throw Error(ErrorCode::resource_limit, std::string("cannot make a socket: ") + std::strerror(errno));
    }
    return {Descriptor(ends[0]), Descriptor(ends[1])};
}

namespace {

/// Socket message with one ControlMessage, and space for one attached descriptor.
struct Packet {
    explicit Packet(ControlMessage& message) {
        part = {&message, sizeof message};
        header.msg_iov = &part;
        header.msg_iovlen = 1;
        header.msg_control = room;
        header.msg_controllen = sizeof room;
    }
    Packet(const Packet&) = delete;
    Packet& operator=(const Packet&) = delete;

    iovec part{};
    msghdr header{};
    alignas(cmsghdr) char room[CMSG_SPACE(sizeof(int))] = {};
};

}  // namespace

bool send_message(const Descriptor& socket, const ControlMessage& message, int file) {
    ControlMessage copy = message;
    Packet packet(copy);
    if (file >= 0) {
        cmsghdr* const attached = CMSG_FIRSTHDR(&packet.header);
        attached->cmsg_level = SOL_SOCKET;
        attached->cmsg_type = SCM_RIGHTS;
        attached->cmsg_len = CMSG_LEN(sizeof file);
        std::memcpy(CMSG_DATA(attached), &file, sizeof file);
    } else {
        packet.header.msg_control = nullptr;
        packet.header.msg_controllen = 0;
    }
    ssize_t sent = 0;
    do {
        sent = ::sendmsg(socket.number(), &packet.header, MSG_NOSIGNAL | MSG_DONTWAIT);
    } while (sent < 0 && errno == EINTR);
    return sent == ssize_t(sizeof message);
}

std::optional<ReceivedMessage> receive_message(const Descriptor& socket) {
    ReceivedMessage received;
    Packet packet(received.message);
    ssize_t got = 0;
    do {
        got = ::recvmsg(socket.number(), &packet.header, MSG_CMSG_CLOEXEC);
    } while (got < 0 && errno == EINTR);
    if (got != ssize_t(sizeof received.message)) return std::nullopt;
    const cmsghdr* const attached = CMSG_FIRSTHDR(&packet.header);
    if (attached != nullptr && attached->cmsg_type == SCM_RIGHTS && attached->cmsg_len == CMSG_LEN(sizeof(int))) {
        int file = -1;
        std::memcpy(&file, CMSG_DATA(attached), sizeof file);
        received.file = Descriptor(file);
    }
    return received;
}

}  // namespace octopair
