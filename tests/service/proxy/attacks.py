"""HTTP/2 connections for tests of attacks: sends single frames over TLS or TCP, from a chosen source address."""

import pathlib
import socket
import ssl
import struct
import sys
import time

sys.path.append(str(pathlib.Path(__file__).parents[1] / "foreign"))
from http2 import CONTINUATION, DATA, END_HEADERS, END_STREAM, HEADERS, PREFACE, RESET, SETTINGS, encoded_length, frame, header  # noqa: E402


def call_header(path, token):
    """Returns the header of a gRPC call."""
    return b"".join(header(name, value) for name, value in [
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
        self.socket.sendall(PREFACE + frame(SETTINGS))

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
        head = frame(HEADERS, call_header(path, token), END_HEADERS, stream)
        self.socket.sendall(head + frame(DATA, EMPTY_MESSAGE, END_STREAM, stream))
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
    "a field whose name has 2,000,000,000 bytes": (b"\0" + encoded_length(2_000_000_000) + b"x" * 16000, b"x" * 16000),
    "fields of 200 bytes": (header("a" * 97, "b" * 100) * 80, header("a" * 97, "b" * 100) * 80),
}


def send_endless_header(connection, stream, fragments, most_bytes, seconds):
    """Sends HEADERS without END_HEADERS and then CONTINUATION frames. `fragments`: an item of ENDLESS_HEADERS.
    Returns the number of bytes sent until the connection was cut, or None if it was not."""
    first, further = fragments
    if not connection.send(frame(HEADERS, first, 0, stream)):
        return 0
    sent, end = len(first), time.monotonic() + seconds
    while sent < most_bytes and time.monotonic() < end:
        if not connection.send(frame(CONTINUATION, further, 0, stream)):
            return sent
        sent += len(further)
    return None


def reset_rapidly(port, authority, source, token, seconds):
    """Starts calls and resets each at once, for some seconds. Connects again when it is cut. Returns the number of calls."""
    calls, end, fields = 0, time.monotonic() + seconds, call_header("/octopair.v1.Octopair/Status", token)
    while time.monotonic() < end:
        try:
            connection = Connection(port, authority, source)
            connection.start()
        except OSError:
            time.sleep(0.01)
            continue
        stream = 1
        while time.monotonic() < end:
            batch = b"".join(frame(HEADERS, fields, END_HEADERS, number) + frame(RESET, b"\0\0\0\x08", 0, number)
                             for number in range(stream, stream + 100, 2))
            if not connection.send(batch):
                break
            stream += 100
            calls += 50
        connection.close()
    return calls
