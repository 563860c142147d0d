#!/usr/bin/python3
"""Polite clients: each sends a small job by DetectSmall, waits for the pairs, and pauses.

    polite.py ADDRESS [--clients N] [--seconds S] [--pause S]

Prints a JSON object: `milliseconds` of each call, and `errors`, a list of texts.
"""
import array
import json
import pathlib
import subprocess
import sys
import threading
import time

import grpc

import protocol
import settings
from boxes import find_pairs, make_boxes
from client import uploads
from server import POLITE, TOKENS

OBJECTS = 1000
CALL_SECONDS = 60


class Polite(threading.Thread):
    """A polite client."""

    def __init__(self, address, name, pause, until):
        super().__init__()
        self._address, self._name, self._pause, self._until = address, name, pause, until
        self.milliseconds, self.errors = [], []

    def run(self):
        boxes = make_boxes(OBJECTS, seed=1)
        right = array.array("I", [number for pair in find_pairs(boxes) for number in pair]).tobytes()
        request, metadata = uploads(boxes)[0].SerializeToString(), [("authorization", f"Bearer {TOKENS[self._name]}")]
        with grpc.insecure_channel(self._address, [("grpc.use_local_subchannel_pool", 1)]) as channel:
            detect = channel.unary_unary(f"/{protocol.SERVICE}/DetectSmall")
            while time.monotonic() < self._until:
                begin = time.monotonic()
                try:
                    if right not in detect(request, metadata=metadata, timeout=CALL_SECONDS):
                        self.errors.append("wrong pairs")
                except grpc.RpcError as error:
                    self.errors.append(f"{error.code().name}: {error.details()}")
                self.milliseconds.append(1000 * (time.monotonic() - begin))
                time.sleep(self._pause)


def run(address, clients, seconds, pause):
    """Runs polite clients in a process of their own. Returns (sorted milliseconds, errors)."""
    words = [sys.executable, str(pathlib.Path(__file__).resolve()), address, "--clients", str(clients), "--seconds", str(seconds),
             "--pause", str(pause), "--proto", str(settings.proto())]
    printed = json.loads(subprocess.run(words, check=True, stdout=subprocess.PIPE, text=True).stdout)
    return sorted(printed["milliseconds"]), printed["errors"]


def main():
    """Runs the command line."""
    parser = settings.parser(__doc__)
    parser.add_argument("address")
    parser.add_argument("--clients", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=4)
    parser.add_argument("--pause", type=float, default=0.02)
    given = settings.parse_without_program(parser)
    protocol.messages()
    until = time.monotonic() + given.seconds
    clients = [Polite(given.address, POLITE[i], given.pause, until) for i in range(given.clients)]
    for client in clients:
        client.start()
    for client in clients:
        client.join()
    print(json.dumps({"milliseconds": [time for client in clients for time in client.milliseconds],
                      "errors": [error for client in clients for error in client.errors]}))


if __name__ == "__main__":
    main()
