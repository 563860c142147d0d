#!/usr/bin/python3
"""Sends random mutations of valid messages to all methods, over several connections at a time, and valid jobs in between.

    fuzz_test.py --program PATH [--messages N] [--seed S] [--first I]

Each message depends only on the seed and its number. This repeats message I alone: --first I --messages 1.
"""
import collections
import os
import random
import sys
import threading
import time

import protocol
import recording
import settings
from boxes import find_pairs, make_boxes
from client import Client, bytes_of, new_id, uploads
from mutations import is_malformed, mutated
from server import Server

CONNECTIONS = 4
CALL_SECONDS = 30
LIMITS = ("--max-objects", 100_000, "--max-input", "8M", "--max-pairs", 1_000_000, "--max-memory", "512M", "--max-state", "256M",
          "--max-seconds", 20, "--stall", 5)
EXPECTED = {"OK", "INVALID_ARGUMENT", "RESOURCE_EXHAUSTED", "CANCELLED"}
CLEAN_EVERY = 200  # messages of a connection, after which it removes its jobs
VALID_EVERY = 25


def unexpected_code(name, answer, requests):
    """Returns whether a call with mutated messages must not get this code."""
    if answer.code.name == "OK" and any(is_malformed(protocol.methods()[name].request, one) for one in requests):
        return True
    if name in ("Wait", "WatchScene") and answer.code.name == "DEADLINE_EXCEEDED":
        return False  # the message asks to wait for up to an hour or a minute
    if name == "Submit" and answer.code.name == "UNAVAILABLE" and "released" in answer.text:
        return False  # another connection released the job during the upload
    return answer.code.name not in EXPECTED


class Fuzz:
    """The messages of a run, and what went wrong."""

    def __init__(self, server, seed, also_accepted=()):
        self._server, self._seed, self._also_accepted = server, seed, also_accepted
        self.failures, self.codes = [], collections.Counter()
        self._boxes = make_boxes(100, seed=1)
        self._pairs = find_pairs(self._boxes)
        self.job_id = "00000000-0000-4000-8000-000000000000"  # a job that exists at most times
        self.scene_id = ""  # a scene that runs all the time

    def valid_messages(self, name, generator):
        """Returns the messages of a valid call of the method."""
        job_id = generator.choice((self.job_id, "%08x-0000-4000-8000-000000000000" % generator.randrange(20)))
        if name in ("Detect", "DetectSmall", "Submit"):
            fields = generator.choice(({}, dict(margin=0.1), dict(limit=5), dict(count_only=True), dict(order=1)))
            boxes = make_boxes(generator.randrange(30), generator.randrange(3))
            size = 1 << 20 if name == "DetectSmall" else generator.choice((100, 1 << 20))
            return [bytes_of(one) for one in uploads(boxes, size, id=job_id, **fields)]
        if name == "Scene":
            return [bytes_of(one) for one in recording.scene_uploads(make_boxes(generator.randrange(1, 20), 1))]
        fields = {"Wait": dict(id=job_id, seconds=0.1), "Result": dict(id=job_id, offset=1), "List": dict(after=job_id),
                  "ListScenes": dict(after=job_id), "WatchScene": dict(id=self.scene_id, pair_limit=10, seconds=0.1),
                  "Describe": {}}.get(name, dict(id=job_id))
        return [bytes_of(protocol.methods()[name].request(**fields))]

    def send(self, client, number):
        """Sends message `number`, and checks the code of the answer."""
        generator = random.Random(f"{self._seed}/{number}")
        name = generator.choice(protocol.ordinary_methods())
        requests = self.valid_messages(name, generator)
        at = generator.randrange(len(requests))
        requests[at] = mutated(generator, requests[at])
        answer = client.call(name, *requests, timeout=2 if name in ("Wait", "WatchScene") else CALL_SECONDS)
        self.codes[name, answer.code.name] += 1
        if unexpected_code(name, answer, requests) and answer.code.name not in self._also_accepted:
            self.failures.append(f"message {number}: {name} {[one[:200].hex() for one in requests]}: {answer}")

    def check_valid(self, client, number):
        """Runs valid jobs of another client, and checks their pairs."""
        answers = [client.detect_small(self._boxes), client.detect(self._boxes)]
        job_id = new_id()
        if client.submit(self._boxes, job_id).code.name == "OK":
            client.wait(job_id)
        answers.append(client.result(job_id))
        client.job("Release", job_id)
        for answer in answers:
            if answer.code.name != "OK" or answer.pairs() != self._pairs:
                self.failures.append(f"valid job after message {number}: {answer}")

    def clean(self, client):
        """Removes all jobs of a client, and submits the job that messages name."""
        for job_id in client.ids():
            client.job("Cancel", job_id)
            client.job("Release", job_id)
        client.submit(self._boxes, self.job_id)

    def run(self, numbers):
        """Sends the messages with these numbers, over one connection."""
        with Client(self._server, "greedy") as client, Client(self._server, "anna") as other:
            self.clean(client)
            for count, number in enumerate(numbers):
                if len(self.failures) > 100 or not self._server.lives():
                    break
                self.send(client, number)
                if count % VALID_EVERY == 0:
                    self.check_valid(other, number)
                if count % CLEAN_EVERY == CLEAN_EVERY - 1:
                    self.clean(client)


def run_all(server, options):
    """Sends the messages over all connections. Returns the Fuzz."""
    fuzz, end = Fuzz(server, options.seed, options.also_accept), options.first + options.messages
    threads = [threading.Thread(target=fuzz.run, args=(range(options.first + i, end, CONNECTIONS),))
               for i in range(CONNECTIONS)]
    with Client(server, "greedy") as client, recording.running_scene(client, make_boxes(100, seed=1)) as scene_id:
        fuzz.scene_id = scene_id
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    return fuzz


def check_server(server, fuzz):
    """Adds the faults of the server itself to the failures."""
    if not server.lives():
        fuzz.failures.append(f"the server ended with {server.exit_status()}")
    else:
        with Client(server, "anna") as client:
            fuzz.check_valid(client, "all")
    fuzz.failures += [f"a path of the server in: {text}" for text in sorted(set(server.leaked_texts()))]
    fuzz.failures += [f"a broken log line: {line}" for line in server.broken_log_lines()]


def main():
    """Runs the command line. Returns the exit status."""
    parser = settings.parser(__doc__)
    parser.add_argument("--messages", type=int, default=int(os.environ.get("OCTOPAIR_FUZZ_MESSAGES", 2000)))
    parser.add_argument("--seed", default=os.environ.get("OCTOPAIR_FUZZ_SEED", "1"))
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--also-accept", nargs="*", default=[], metavar="CODE", help="further status codes that are no failure")
    options, _ = settings.parse(parser)
    begin = time.monotonic()
    with Server(*LIMITS) as server:
        fuzz = run_all(server, options)
        check_server(server, fuzz)
        memory = server.resident_bytes() >> 20 if server.lives() else 0
    if "Sanitizer" in server.last_log or fuzz.failures:
        fuzz.failures.append("log of the server:\n" + server.last_log[-8000:])
    for failure in [*fuzz.failures[:20], *fuzz.failures[20:][-1:]]:
        print(failure, file=sys.stderr)
    last = options.first + options.messages - 1
    print(f"seed {options.seed}, messages {options.first} to {last}: {len(fuzz.failures)} failures, "
          f"{time.monotonic() - begin:.1f} s, resident memory of the server: {memory} MiB")
    print(", ".join(f"{name} {code} {count}" for (name, code), count in sorted(fuzz.codes.items())))
    return 1 if fuzz.failures else 0


if __name__ == "__main__":
    sys.exit(main())
