#!/usr/bin/python3
"""A greedy client with a token: it takes all that its limits allow, until the process is killed.

    greedy.py ADDRESS

The client opens connections, leaves results unread, sends many large jobs, attached and detached, and makes many small calls.
"""
import pathlib
import subprocess
import sys
import threading
import time

import grpc

import hostile
import http2
import protocol
import settings
from boxes import equal_boxes, make_boxes
from client import Client, bytes_of, new_id, spec_of, uploads
from server import TOKENS

CONNECTIONS = 100
UNREAD_CONNECTIONS, UNREAD_STREAMS = 7, 100
ATTACHED, DETACHED, CALLERS = 8, 4, 2  # threads
LARGE = 60_000  # equal boxes: 1.8 * 10^9 pairs to count


class _Target:
    """An address of a server that another process has started, for Client."""

    def __init__(self, address):
        self.address, self.texts = address, []


def _repeated(work):
    """Returns a thread that repeats a function, also after errors."""
    def run():
        while True:
            try:
                work()
            except (OSError, RuntimeError, grpc.RpcError, ValueError):
                pass
            time.sleep(0.01)
    return threading.Thread(target=run, daemon=True)


class Greedy:
    """The parts of the greedy client."""

    def __init__(self, address):
        self._address, self._token = address, TOKENS["greedy"]
        self._client = Client(_Target(address), "greedy")
        self._counted = bytes_of(protocol.messages().Upload(data=equal_boxes(LARGE).tobytes()))
        self._large = make_boxes(20_000, seed=1, size=0.02) * 10
        self._held = []

    def hold_connections(self):
        """Opens connections, and makes a call over each."""
        self._held = [one for one in self._held if not one.closed]
        while len(self._held) < CONNECTIONS:
            self._held.append(http2.admitted(self._address, self._token))
        time.sleep(1)

    def leave_results_unread(self):
        """Makes a large result, and starts downloads that it does not read."""
        job_id = new_id()
        self._client.submit(equal_boxes(3000), job_id)
        self._client.wait(job_id)
        held = [hostile.start_unread_results(self._address, self._token, job_id, UNREAD_STREAMS)
                for _ in range(UNREAD_CONNECTIONS)]
        time.sleep(10)
        for connection in held:
            connection.socket.close()

    def send_attached(self):
        """Runs a job of 200,000 boxes, with 4.8 MB of input."""
        with Client(_Target(self._address), "greedy") as client:
            client.finish("Detect", client.open("Detect", map(bytes_of, uploads(self._large, id=new_id()))))

    def send_detached(self):
        """Submits a job that takes long, and releases it after its end."""
        job_id, spec = new_id(), spec_of(LARGE, count_only=True)
        spec.id = job_id
        head = bytes_of(protocol.messages().Upload(spec=spec))
        self._client.finish("Submit", self._client.open("Submit", iter([head, self._counted])))
        self._client.wait(job_id)
        self._client.job("Release", job_id)

    def make_calls(self):
        """Makes calls as fast as the server answers, 50 at a time."""
        stream = 3
        with http2.admitted(self._address, self._token) as connection:
            while not connection.closed:
                connection.send(b"".join(http2.unary_call(one, "List", token=self._token)
                                         for one in range(stream, stream + 100, 2)))
                stream += 100
                connection.wait_for_end(50)

    def start(self):
        """Starts all threads."""
        works = [self.hold_connections, self.leave_results_unread, *[self.send_attached] * ATTACHED,
                 *[self.send_detached] * DETACHED, *[self.make_calls] * CALLERS]
        for work in works:
            _repeated(work).start()


def start(address, nice=10):
    """Starts a greedy client as a process. Returns the process."""
    return subprocess.Popen(["nice", "-n", str(nice), sys.executable, str(pathlib.Path(__file__).resolve()), address,
                             "--proto", str(settings.proto())])


def main():
    """Runs the command line."""
    parser = settings.parser(__doc__)
    parser.add_argument("address")
    Greedy(settings.parse_without_program(parser).address).start()
    threading.Event().wait()


if __name__ == "__main__":
    main()
