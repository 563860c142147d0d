#!/usr/bin/python3
"""A port that reads and ignores all bytes: the control of a measurement with hostile connections.

    sink.py [--answer]

Prints its address. Each connection gets the frames that a client of HTTP/2 waits for: SETTINGS, and the end of stream 1. With
--answer, each further call gets an answer, too.
"""
import argparse
import selectors
import socket
import struct
import subprocess
import sys

import http2

END_OF_CALL = b"\x88"  # ":status: 200"


def answer_to(stream):
    """Returns the frame that ends a call."""
    return http2.frame(http2.HEADERS, END_OF_CALL, http2.END_STREAM | http2.END_HEADERS, stream)


class Calls:
    """Finds the ends of requests in the bytes of a connection."""

    def __init__(self):
        self._rest = b""
        self._begun = False

    def answers(self, data):
        """Returns the frames that answer the calls whose requests end in these bytes."""
        data = self._rest + data
        at, frames = 0 if self._begun else len(http2.PREFACE), []
        while len(data) >= at + http2.FRAME_HEAD:
            size = http2.FRAME_HEAD + int.from_bytes(data[at:at + 3], "big")
            if len(data) < at + size:
                break
            kind, flags, stream = struct.unpack(">BBI", data[at + 3:at + http2.FRAME_HEAD])
            if kind == http2.DATA and flags & http2.END_STREAM and stream > 1:
                frames.append(answer_to(stream))
            at, self._begun = at + size, True
        self._rest = data[at:] if self._begun else data
        return b"".join(frames)


def serve(listener, answers):
    """Reads all connections until the process is killed."""
    selector = selectors.DefaultSelector()
    selector.register(listener, selectors.EVENT_READ)
    buffer = bytearray(1 << 20)
    while True:
        for key, _ in selector.select():
            if key.fileobj is listener:
                connection = listener.accept()[0]
                connection.sendall(http2.frame(http2.SETTINGS) + answer_to(1))
                selector.register(connection, selectors.EVENT_READ, Calls())
                continue
            try:
                count = key.fileobj.recv_into(buffer)
                if answers and count:
                    key.fileobj.sendall(key.data.answers(bytes(buffer[:count])))
            except OSError:
                count = 0
            if not count:
                selector.unregister(key.fileobj)
                key.fileobj.close()


class Sink:
    """A sink as a process: its `address`, and stop()."""

    def __init__(self, answers=False):
        words = [sys.executable, __file__] + (["--answer"] if answers else [])
        self._process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
        self.address = self._process.stdout.readline().strip()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._process.kill()
        self._process.wait()
        self._process.stdout.close()


def main():
    """Runs the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--answer", action="store_true")
    listener = socket.create_server(("127.0.0.1", 0), backlog=1024)
    print(f"127.0.0.1:{listener.getsockname()[1]}", flush=True)
    serve(listener, parser.parse_args().answer)


if __name__ == "__main__":
    main()
