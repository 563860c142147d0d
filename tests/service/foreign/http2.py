"""HTTP/2 by hand (RFC 9113): frames, gRPC calls as frames, and a connection that can violate every rule."""
import select
import socket
import struct
import time

import protocol

PREFACE = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"
DATA, HEADERS, RESET, SETTINGS, PING, GOAWAY, WINDOW_UPDATE, CONTINUATION = 0, 1, 3, 4, 6, 7, 8, 9
END_STREAM, END_HEADERS, ACK = 1, 4, 1
FRAME_HEAD = 9


def frame(kind, payload=b"", flags=0, stream=0):
    """Returns the bytes of a frame."""
    return struct.pack(">I", len(payload))[1:] + bytes([kind, flags]) + struct.pack(">I", stream) + payload


def encoded_length(number):
    """Encodes the length of a literal (RFC 7541, 5.1, a prefix of 7 bits)."""
    if number < 127:
        return bytes([number])
    number -= 127
    encoded = bytearray([127])
    while number >= 128:
        encoded.append(number % 128 + 128)
        number //= 128
    return bytes([*encoded, number])


def header(name, value):
    """Encodes a header as a literal without a table entry."""
    return b"\0" + encoded_length(len(name)) + name.encode() + encoded_length(len(value)) + value.encode()


def call_head(stream, path, token=None, flags=END_HEADERS, **more):
    """Returns the HEADERS frame that starts a gRPC call. `path` is a method's name, or a path with slashes."""
    path = path if path.startswith("/") else f"/{protocol.SERVICE}/{path}"
    fields = {":method": "POST", ":scheme": "http", ":path": path, ":authority": "localhost", "te": "trailers",
              "content-type": "application/grpc"}
    if token:
        fields["authorization"] = f"Bearer {token}"
    fields.update({name.replace("_", "-"): value for name, value in more.items()})
    return frame(HEADERS, b"".join(header(*field) for field in fields.items()), flags, stream)


def message(payload, compressed=0, length=None):
    """Returns a gRPC message: the flag, the length (or a false one), and the payload."""
    return bytes([compressed]) + struct.pack(">I", len(payload) if length is None else length) + payload


def unary_call(stream, path, payload=b"", token=None):
    """Returns the frames of a complete call with one message."""
    return call_head(stream, path, token) + frame(DATA, message(payload), END_STREAM, stream)


def open_socket(address):
    """Returns a connected socket."""
    if address.startswith("unix:"):
        connection = socket.socket(socket.AF_UNIX)
        connection.connect(address[5:])
        return connection
    host, port = address.rsplit(":", 1)
    return socket.create_connection((host.strip("[]"), int(port)), timeout=30)


class Connection:
    """A raw connection to a server."""

    def __init__(self, address):
        self.socket = open_socket(address)
        self.socket.setblocking(False)
        self.closed = False
        self._rest = b""
        self._ended = []  # streams that the server has ended, and wait_for_end() has not counted
        self._windows = {0: 65535}
        self._initial_window = 65535

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.close()

    def greet(self, settings=b""):
        """Sends the preface and a SETTINGS frame. Returns this connection."""
        self.send(PREFACE + frame(SETTINGS, settings))
        return self

    def _ready(self, event, seconds):
        watched = select.poll()
        watched.register(self.socket, event)
        return bool(watched.poll(1000 * seconds))

    def send(self, data, seconds=5.0):
        """Sends bytes. Returns False if the connection is closed, or does not accept the bytes for `seconds`."""
        view, end = memoryview(data), time.monotonic() + seconds
        while view and not self.closed:
            try:
                view = view[self.socket.send(view):]
            except BlockingIOError:
                left = end - time.monotonic()
                if left <= 0 or not self._ready(select.POLLOUT, left):
                    return False
            except OSError:
                self.closed = True
        return not self.closed

    def receive(self, seconds):
        """Returns the bytes that arrive next, or no bytes if none arrive within `seconds` or the connection is closed."""
        try:
            if self.closed or not self._ready(select.POLLIN, seconds):
                return b""
            data = self.socket.recv(1 << 20)
        except OSError:
            data = b""
        self.closed = not data
        return data

    def is_closed_within(self, seconds):
        """Reads until the server closes the connection, for `seconds` at most. Returns whether the connection is closed."""
        end = time.monotonic() + seconds
        while not self.closed and time.monotonic() < end:
            self.receive(max(0.0, end - time.monotonic()))
        return self.closed

    def frames(self, seconds):
        """Yields (kind, flags, stream, payload) of the frames that arrive within `seconds`."""
        end = time.monotonic() + seconds
        while True:
            while len(self._rest) >= FRAME_HEAD:
                size = FRAME_HEAD + int.from_bytes(self._rest[:3], "big")
                if len(self._rest) < size:
                    break
                one, self._rest = self._rest[:size], self._rest[size:]
                kind, flags, stream = struct.unpack(">BBI", one[3:FRAME_HEAD])
                self._note_window(kind, flags, stream, one[FRAME_HEAD:])
                if (kind in (HEADERS, DATA) and flags & END_STREAM) or kind == RESET:
                    self._ended.append(stream)
                yield kind, flags, stream, one[FRAME_HEAD:]
            left = end - time.monotonic()
            data = self.receive(max(0.0, left))
            if not data and (self.closed or left <= 0):
                return
            self._rest += data

    def _note_window(self, kind, flags, stream, payload):
        if kind == WINDOW_UPDATE:
            self._windows[stream] = self._windows.get(stream, self._initial_window) + int.from_bytes(payload, "big")
        if kind == SETTINGS and not flags & ACK:
            self.send(frame(SETTINGS, flags=ACK))
            for at in range(0, len(payload), 6):
                name, value = struct.unpack(">HI", payload[at:at + 6])
                if name == 4:
                    self._windows = {one: window + (value - self._initial_window if one else 0)
                                     for one, window in self._windows.items()}
                    self._initial_window = value

    def send_data(self, stream, data, flags=END_STREAM, seconds=30.0):
        """Sends DATA frames within the windows that the server grants, unless it ends the stream. Returns whether all were sent."""
        end = time.monotonic() + seconds
        self._windows.setdefault(stream, self._initial_window)
        while data and not self.closed and stream not in self._ended and time.monotonic() < end:
            size = min(len(data), 16384, self._windows[0], self._windows[stream])
            if size <= 0:
                for _ in self.frames(0.02):
                    pass
                continue
            self._windows[0] -= size
            self._windows[stream] -= size
            piece, data = data[:size], data[size:]
            if not self.send(frame(DATA, piece, 0 if data else flags, stream)):
                return False
        return not data

    def wait_for_end(self, streams, seconds=30.0):
        """Waits until the server has ended this number of streams, for `seconds` at most. Returns how many it has ended."""
        if len(self._ended) < streams:
            for _ in self.frames(seconds):
                if len(self._ended) >= streams:
                    break
        ended, self._ended = len(self._ended), []
        return ended


def admitted(address, token, seconds=30.0):
    """Returns a connection that has made a call with a token. The server no longer treats it as a stranger's.

    A server at its limit may refuse connections for a moment, while it closes others. So this tries for `seconds`.
    """
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        connection = Connection(address).greet()
        connection.send(unary_call(1, "Describe", token=token))
        if connection.wait_for_end(1, end - time.monotonic()) == 1:
            return connection
        connection.socket.close()
        time.sleep(0.02)
    raise RuntimeError("the server does not answer Describe")
