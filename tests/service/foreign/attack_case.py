"""Base class of the attack tests: a server for each test, and checks at its end that the server still works."""
import concurrent.futures
import contextlib
import resource
import time
import unittest

import settings
from boxes import find_pairs, make_boxes
from client import Client
from server import MemoryWatch, Server, wait_until

PROMPT_SECONDS = 10  # far more than a small job takes on a loaded machine, far less than a blocked server
MEBIBYTE = 1 << 20


def raise_open_files():
    """Raises the limit on open files of this process as far as the system allows."""
    most = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))


def together(function, arguments):
    """Calls a function with each of the arguments, in threads. Returns the results in order, or raises the first exception."""
    with concurrent.futures.ThreadPoolExecutor(max_workers=32) as pool:
        return list(pool.map(function, arguments))


class AttackCase(unittest.TestCase):
    """Each test has a server with tokens, made with the class's `options`, and an authenticated client `anna`."""

    options = ()
    address = "127.0.0.1:0"

    def setUp(self):
        raise_open_files()
        self.server = self.start()
        self.anna = self.client()

    def start(self, *options, **settings_of_server):
        """Starts a server, and checks it when the test ends. Returns the server."""
        settings_of_server.setdefault("address", self.address)
        server = Server(*(options or self.options), **settings_of_server)
        self.addCleanup(self.stop_server, server)
        self.addCleanup(self.check_server, server)
        return server

    def client(self, token="anna", server=None):
        """Returns a client, which is closed when the test ends."""
        client = Client(server or self.server, token)
        self.addCleanup(client.channel.close)
        return client

    def check_server(self, server):
        """Checks that the server runs, has not sent one of its paths, and has written whole log lines."""
        log = server.log()
        self.assertTrue(server.lives(), f"the server ended with {server.exit_status()}: {log[-4000:]}")
        leaks = sorted(set(server.leaked_texts()), key=len)
        self.assertFalse(leaks[:1], f"{len(leaks)} texts for clients contain a path of the server")
        self.assertEqual(server.broken_log_lines(), [], "a client can write lines of the log")

    def stop_server(self, server):
        """Stops the server, and checks that no sanitizer has reported an error or a leak."""
        server.stop()
        self.assertNotIn("Sanitizer", server.last_log)

    def assert_serves(self, client=None, seconds=PROMPT_SECONDS):
        """Asserts that a client (by default a new client with the token of anna) gets the right pairs within `seconds`."""
        boxes = make_boxes(200, seed=1)
        begin = time.monotonic()
        answer = (client or self.client()).detect_small(boxes, timeout=seconds)
        self.assertEqual(answer.code.name, "OK", f"{answer} after {time.monotonic() - begin:.1f} s")
        self.assertEqual(answer.pairs(), find_pairs(boxes))

    def assert_code(self, answer, *names):
        """Asserts that a call ended with a status code of `names`."""
        self.assertIn(answer.code.name, names, str(answer))

    def assert_limit(self, answer, *names):
        """Asserts that a call was refused because of a limit of `names`."""
        self.assert_code(answer, "RESOURCE_EXHAUSTED")
        self.assertIn(answer.limit(), names, str(answer))

    def assert_becomes_true(self, predicate, words, seconds=60):
        """Asserts that a condition becomes true within `seconds`."""
        self.assertTrue(wait_until(predicate, seconds), words)

    @contextlib.contextmanager
    def assert_memory_grows_less_than(self, mebibytes):
        """Asserts that the server's memory grows by less than this in a `with` block. A sanitizer takes memory of its own."""
        before = self.server.resident_bytes()
        with MemoryWatch(self.server) as watch:
            yield
        grown = (watch.most - before) / MEBIBYTE
        self.assertLess(grown, mebibytes * (6 if settings.is_sanitized() else 1), "MiB more than before")
