"""Floods of frames, and headers that never end: they take little memory and time, and other clients get answers meanwhile.

Calls that are reset at once and headers that never end are tested for strangers alone. For a client with a token gRPC has no bound;
packaging/proxy has one, and tests of its own.
"""
import hostile
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
        self.flood("rapid reset, stream", connections=8, seconds=2)

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
