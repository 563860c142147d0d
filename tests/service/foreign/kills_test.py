#!/usr/bin/python3
"""Kills the server (SIGKILL) repeatedly, while clients submit, read and release detached jobs. Then checks that no acknowledged job
is lost or wrong, and that no released job is back.

    kills_test.py --program PATH [--kills K] [--clients N] [--seed S]
"""
import os
import random
import sys
import threading
import time
import uuid

import settings
from boxes import find_pairs, make_boxes
from client import Client
from server import Server, wait_until

DONE = 3  # JobState
PAUSE_SECONDS = 0.005  # of a client between jobs
REPEAT_SECONDS = 60  # time for a client to find the next server
LOST_SERVER = {"UNAVAILABLE", "CANCELLED", "INTERNAL", "UNKNOWN"}  # codes of calls that a kill breaks


class Job:
    """A job that a client has submitted. `wanted` is "kept", "released", or "either" if a call has not been acknowledged."""

    def __init__(self, seed):
        self.seed = seed
        self.id = str(uuid.UUID(int=random.Random(f"id {seed}").getrandbits(128), version=4))
        self.wanted = "either"

    def boxes(self):
        """Returns the input."""
        return make_boxes(40, self.seed, size=0.3)

    def pairs(self):
        """Returns the right result."""
        return find_pairs(self.boxes())


class Submitter(threading.Thread):
    """A client that submits jobs until `over` is set. Each third job is read, each sixth is also released."""

    def __init__(self, server, seed, over):
        super().__init__(daemon=True)
        self._server, self._seed, self._over = server, seed, over
        self._client = Client(server)
        self.jobs, self.failures = [], []
        self.acknowledged = self.repeated = 0

    def run(self):
        while not self._over.is_set() and len(self.failures) < 10:
            job = Job(f"{self._seed}/{len(self.jobs)}")
            self.jobs.append(job)
            self._submit(job)
            if len(self.jobs) % 3 == 0 and job.wanted == "kept":
                self._read(job, release=len(self.jobs) % 6 == 0)
            time.sleep(PAUSE_SECONDS)
        self._client.channel.close()

    def _connect_again(self):
        """Replaces the connection. gRPC itself would wait for seconds before it connects again."""
        self._client.channel.close()
        self._client = Client(self._server)

    def _until_answered(self, call, expected):
        """Repeats a call while the server is down. Returns the first answer with an expected code; None if there is none."""
        end = time.monotonic() + REPEAT_SECONDS
        while time.monotonic() < end:
            answer = call()
            if answer.code.name in expected:
                return answer
            if answer.code.name not in LOST_SERVER:
                self.failures.append(f"{answer}, expected {expected}")
                return None
            self.repeated += 1
            time.sleep(0.02)
            self._connect_again()
        self.failures.append(f"no server for {REPEAT_SECONDS} s: {answer}")
        return None

    def _submit(self, job):
        if self._until_answered(lambda: self._client.submit(job.boxes(), job.id), {"OK"}):
            job.wanted = "kept"
            self.acknowledged += 1

    def _read(self, job, release):
        answer = self._until_answered(lambda: self._client.result(job.id), {"OK"})
        if answer and answer.pairs() != job.pairs():
            self.failures.append(f"wrong pairs of job {job.id}")
        if release and answer:
            job.wanted = "either"
            # A release without an answer may have happened. Then the job does not exist any more: INVALID_ARGUMENT.
            if self._until_answered(lambda: self._client.job("Release", job.id), {"OK", "INVALID_ARGUMENT"}):
                job.wanted = "released"


def kill_repeatedly(server, submitters, kills, generator):
    """Kills and restarts the server. Each fourth kill hits a server that starts, the others hit a server with jobs."""
    def acknowledged():
        return sum(one.acknowledged for one in submitters)
    for kill in range(kills):
        before = acknowledged()
        if kill % 4 != 3:
            wait_until(lambda: acknowledged() > before, 30)
            time.sleep(generator.uniform(0, 0.2))
        server.kill()
        server.spawn()
        if kill % 4 == 2:
            time.sleep(generator.uniform(0, 0.05))
        else:
            server.wait_until_started()
    server.kill()
    server.start()


def check_job(client, job):
    """Returns what is wrong with a job after all kills, or an empty text."""
    if job.wanted == "released":
        return "" if client.job("Status", job.id).code.name == "INVALID_ARGUMENT" else f"released job {job.id} is back"
    if job.wanted == "either":
        return ""
    report = client.wait(job.id)
    if report.code.name != "OK":
        return f"acknowledged job {job.id} is lost: {report}"
    if report.messages[0].state != DONE:
        return f"job {job.id} has not run: {report.messages[0]}"
    if client.result(job.id).pairs() != job.pairs():
        return f"wrong pairs of job {job.id}"
    if client.submit(job.boxes(), job.id).code.name != "OK":
        return f"job {job.id} cannot be submitted again"
    if client.submit(make_boxes(40, "other"), job.id).code.name != "INVALID_ARGUMENT":
        return f"job {job.id} can be submitted with other input"
    return ""


def check_all(server, jobs):
    """Checks all jobs, and the list of jobs. Returns what is wrong."""
    with Client(server) as client:
        before = client.ids()
        wrong = [words for job in jobs if (words := check_job(client, job))]
        if client.ids() != before:
            wrong.append("submitting a job again has changed the list of jobs")
    kept, either = ({job.id for job in jobs if job.wanted == wanted} for wanted in ("kept", "either"))
    if not kept <= set(before) <= kept | either or len(before) != len(set(before)):
        wrong.append(f"the list lacks {kept - set(before)} and has too many {set(before) - kept - either}")
    return wrong


def main():
    """Runs the command line. Returns the exit status."""
    parser = settings.parser(__doc__)
    parser.add_argument("--kills", type=int, default=int(os.environ.get("OCTOPAIR_KILLS", 8)))
    parser.add_argument("--clients", type=int, default=4)
    parser.add_argument("--seed", default=os.environ.get("OCTOPAIR_KILLS_SEED", "1"))
    options, _ = settings.parse(parser)
    begin, over = time.monotonic(), threading.Event()
    with Server(address="unix") as server:
        submitters = [Submitter(server, f"{options.seed}/{i}", over) for i in range(options.clients)]
        for one in submitters:
            one.start()
        try:
            kill_repeatedly(server, submitters, options.kills, random.Random(options.seed))
        finally:
            over.set()
        for one in submitters:
            one.join()
        jobs = [job for one in submitters for job in one.jobs]
        failures = [words for one in submitters for words in one.failures] + check_all(server, jobs)
        failures += [f"a path of the server in: {text}" for text in server.leaked_texts()]
        if failures:
            print(server.log()[-4000:], file=sys.stderr)
    for failure in failures[:20]:
        print(failure, file=sys.stderr)
    counts = {wanted: sum(job.wanted == wanted for job in jobs) for wanted in ("kept", "released", "either")}
    repeated = sum(one.repeated for one in submitters)
    print(f"seed {options.seed}, {options.kills} kills: {len(jobs)} jobs {counts}, {repeated} calls repeated, "
          f"{len(failures)} failures, {time.monotonic() - begin:.1f} s")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
