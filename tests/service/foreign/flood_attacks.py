"""Floods of frames, and headers that never end: they take little memory and time, and other clients get answers meanwhile.

Headers that never end are tested for strangers alone. For a client with a token gRPC has no bound; packaging/proxy has one, and tests of
its own.
"""
import hostile
import http2
from attack_case import AttackCase
from server import TOKENS


class FloodCase(AttackCase):
    """Runs floods in a process of their own, and checks the server meanwhile."""

    def flood(self, kind, token=None, connections=3, seconds=0.5, mebibytes=512):
        """Makes hostile connections of a kind, and checks other clients and the memory until they end."""
        self.assert_serves(self.anna)
        with self.assert_memory_grows_less_than(mebibytes):
            process = hostile.start(kind, self.server.address, seconds, connections, TOKENS.get(token))
            self.addCleanup(process.wait)
            self.addCleanup(process.kill)
            while process.poll() is None:
                self.assert_serves(self.anna)
                self.assert_serves()
        self.assertEqual(process.returncode, 0)


class Floods(FloodCase):
    """Without a token a connection is cut soon, and the flood connects again. With a token it stays."""

    def test_rapid_reset(self):
        self.flood("rapid reset", connections=8, seconds=2)
        for kind in hostile.RESET_CALLS:
            with self.subTest(kind=kind):
                self.flood(kind, "greedy", mebibytes=100)

    def test_many_honest_calls(self):
        """No number of calls ends a connection, not even of calls that do not exist, if each ends before the next ones begin."""
        with http2.admitted(self.server.address, TOKENS["greedy"]) as connection:
            connection.send(http2.frame(http2.WINDOW_UPDATE, b"\x3f\0\0\0"))
            for begin in range(3, 6003, 200):
                streams = range(begin, begin + 200, 2)
                connection.send(b"".join(http2.unary_call(one, ("Describe", "Nonsense", "/grpc.health.v1.Health/Check")[one % 3], b"",
                                                          TOKENS["greedy"]) for one in streams))
                self.assertTrue(connection.wait_for_end(len(streams), 30))
            self.assertFalse(connection.closed)

    def test_ping(self):
        self.flood("ping flood")
        self.flood("ping flood", "greedy")

    def test_settings(self):
        self.flood("settings flood")
        self.flood("settings flood", "greedy")

    def test_other_protocols(self):
        self.flood("garbage")
        self.flood("client hello")

    def test_endless_headers(self):
        for kind in hostile.ENDLESS_HEADERS:
            with self.subTest(kind=kind):
                self.flood(f"endless header, {kind}")


class UnixFloods(FloodCase):
    """Floods over a Unix socket, where connections are not cut before their first call."""

    address = "unix"

    def test_floods(self):
        for kind in ("ping flood", "settings flood", "garbage"):
            self.flood(kind)
