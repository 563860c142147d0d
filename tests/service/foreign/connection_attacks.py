"""Attacks by connections: silent, endless, or with another protocol; many connections, few open files; idle readers of metrics."""
import os
import re
import time

import hostile
import http2
import metrics
from attack_case import AttackCase
from boxes import find_pairs, make_boxes
from client import new_id
from http2 import Connection
from server import TOKENS

HALF_MEBIBYTE = 512 << 10


class Strangers(AttackCase):
    """Connections without an admitted call are cut. They take few resources, and leave room for clients."""

    options = ("--max-connections", 40)

    def test_an_endless_header_is_cut(self):
        for kind in hostile.ENDLESS_HEADERS:
            with self.subTest(kind=kind):
                begin = time.monotonic()
                sent = hostile.endless_header(self.server.address, begin + 60, kind=kind, pause=0.02)
                self.assertLess(time.monotonic(), begin + 60, "never cut")
                self.assertGreater(sent, HALF_MEBIBYTE // 4, "cut by gRPC itself: the header is not endless")
                self.assertLess(sent, 2 * HALF_MEBIBYTE, "the server checks the number of bytes 20 times a second")
        self.assert_serves()

    def test_silent_and_watching_connections_leave_room(self):
        held = []
        for i in range(1050):
            connection = Connection(self.server.address)
            held.append(connection)
            if i % 21 == 0:
                connection.greet().send(http2.unary_call(1, "/grpc.health.v1.Health/Watch"))
            if i % 100 == 0:
                self.assert_serves()
        self.assert_serves(self.anna)
        for name in ("anna", "berta"):
            for _ in range(5):
                self.assert_serves(self.client(name))
        self.assertLess(self.server.open_files(), 300)
        for connection in held:
            connection.socket.close()

    def test_connections_without_a_call_are_cut(self):
        server = self.start("--stall", 1)
        attacks = {"silent": b"", "preface": http2.PREFACE, "settings": http2.PREFACE + http2.frame(http2.SETTINGS),
                   "half a preface": http2.PREFACE[:7], "TLS": hostile.CLIENT_HELLO, "HTTP/1": b"GET / HTTP/1.1\r\n\r\n",
                   "random": os.urandom(2000), "zeros": bytes(70_000),
                   "watch": http2.PREFACE + http2.frame(http2.SETTINGS)
                            + http2.unary_call(1, "/grpc.health.v1.Health/Watch"),
                   "long frame": http2.PREFACE + http2.frame(http2.SETTINGS) + b"\xff\xff\xff\0\0\0\0\0\1" + bytes(99)}
        open_connections = {name: Connection(server.address) for name in attacks}
        for name, connection in open_connections.items():
            connection.send(attacks[name])
        for name, connection in open_connections.items():
            self.assertTrue(connection.is_closed_within(40), f"{name}: not cut")
            connection.socket.close()
        self.assert_serves(self.client(server=server))

    def test_a_flood_of_tokenless_calls_writes_few_lines(self):
        calls, begin = 0, time.monotonic()
        while calls < 5000:
            with Connection(self.server.address).greet() as connection:
                while calls < 5000 and not connection.closed:  # the server cuts connections with many such calls
                    batch = [http2.unary_call(2 * i + 1, "Describe") for i in range(calls, calls + 50)]
                    connection.send(b"".join(batch))
                    ended = connection.wait_for_end(50)
                    self.assertTrue(ended == 50 or connection.closed, "calls without an answer")
                    calls += 50
        seconds = time.monotonic() - begin
        lines = [line for line in self.server.log().splitlines() if "call refused" in line]
        self.assertGreater(len(lines), 0)
        self.assertLess(len(lines), seconds + 3, "more than one line a second")
        self.assert_serves(self.anna)


class FewOpenFiles(AttackCase):
    """A server with few open files lowers the limit on connections, and keeps files for its jobs."""

    def test_submit_works(self):
        for open_files in (256, 1024):
            with self.subTest(open_files=open_files):
                server = self.start("--log", "text", open_files=open_files)
                limit = re.search(r"at most (\d+) connections", server.log())
                self.assertTrue(limit, "the log does not say that connections were lowered")
                self.assertLess(int(limit.group(1)), open_files)
                held = [Connection(server.address) for _ in range(open_files)]
                admitted = [http2.admitted(server.address, TOKENS["berta"]) for _ in range(int(limit.group(1)) // 8)]
                anna, boxes = self.client(server=server), make_boxes(200, seed=2)
                anna.call("Describe", b"", wait_for_ready=True)
                for _ in range(5):
                    job_id = new_id()
                    self.assert_code(anna.submit(boxes, job_id), "OK")
                    anna.wait(job_id)
                    self.assertEqual(anna.result(job_id).pairs(), find_pairs(boxes))
                for connection in held + admitted:
                    connection.socket.close()


class Metrics(AttackCase):
    """Idle connections to the port of the metrics do not block a request."""

    def test_idle_connections_do_not_block(self):
        port = metrics.free_port()
        self.start("--metrics", f"127.0.0.1:{port}")
        held = [Connection(f"127.0.0.1:{port}") for _ in range(2)]
        try:
            self.assertIn("octopair_connections", metrics.page(port, seconds=5))
        except TimeoutError:
            self.fail("no answer within 5 s")
        finally:
            for connection in held:
                connection.socket.close()
