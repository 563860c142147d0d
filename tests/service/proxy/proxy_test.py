#!/usr/bin/env python3
"""Tests packaging/proxy/nginx.conf and packaging/proxy/haproxy.cfg: results through the proxies, and attacks on the proxies.

    proxy_test.py --program PATH [TEST...]

PATH is the octopair program (default: $OCTOPAIR_PROGRAM). Needs the Debian packages nginx-light, haproxy and openssl. The tests start
their own octopair, nginx and haproxy at free loopback ports. Attackers connect from 127.0.0.2 and 127.0.0.3, clients from 127.0.0.1.
"""

import argparse
import grp
import itertools
import os
import pathlib
import pwd
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest

sys.dont_write_bytecode = True
import attacks  # noqa: E402
import certificates  # noqa: E402
import metrics  # noqa: E402

CONFIGURATIONS = pathlib.Path(__file__).resolve().parents[3] / "packaging/proxy"
PACKAGES = {"nginx": "nginx-light", "haproxy": "haproxy", "openssl": "openssl"}
SYSTEM_PATH = os.environ.get("PATH", "") + ":/usr/sbin:/sbin"
TOKEN, WRONG_TOKEN = "0123456789abcdef" * 4, "fedcba9876543210" * 4
SMALL, LARGE, TOO_LARGE = 1000, 1_000_000, 2_000_000  # objects
MAX_OBJECTS = 1_500_000
ATTACKER, OTHER_ATTACKER = "127.0.0.2", "127.0.0.3"

program = os.environ.get("OCTOPAIR_PROGRAM")
files = None  # folder of certificates, tokens and scenes


def find_program(name):
    path = shutil.which(name, path=SYSTEM_PATH)
    if path is None:
        raise AssertionError(f"{name} is missing: install the Debian package {PACKAGES[name]}")
    return path


def run(*command, timeout=60, **options):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=timeout, **options)


def must_run(*command):
    done = run(*command)
    if done.returncode != 0:
        raise AssertionError(f"{command[0]} ends with status {done.returncode}: {done.stderr}")


def write_secret(path, text):
    path.touch(mode=0o600)
    path.write_text(text)


def make_certificates():
    """Makes an authority, and certificates for the server and for a client (docs/server.md)."""
    find_program("openssl")
    certificates.Authority(files).sign("client", "/CN=client", "DNS:localhost,IP:127.0.0.1")
    write_secret(files / "server-and-key.pem", (files / "server.pem").read_text() + (files / "server.key").read_text())


def make_scenes():
    for objects in [SMALL, LARGE, TOO_LARGE]:
        must_run(program, "generate", "uniform", "--objects", objects, "--output", files / f"{objects}.npy", "--quiet")
    for objects in [SMALL, LARGE]:
        must_run(program, "detect", files / f"{objects}.npy", "--engine", "local", "--output", files / f"{objects}.pairs.npy", "--quiet")


def setUpModule():
    global files
    if not program:
        raise AssertionError("no program: give --program PATH, or set OCTOPAIR_PROGRAM")
    # Not in a private folder of a user: the proxies run as their own users.
    files = pathlib.Path(tempfile.mkdtemp(prefix="octopair-proxy-"))
    unittest.addModuleCleanup(shutil.rmtree, files)
    files.chmod(0o755)
    make_certificates()
    write_secret(files / "tokens", f"anna {TOKEN}\n")
    write_secret(files / "anna.token", TOKEN)
    write_secret(files / "wrong.token", WRONG_TOKEN)
    make_scenes()


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


class Process:
    """A program that listens at a port of 127.0.0.1. Its output goes to a file."""

    def __init__(self, command, port, output):
        self.output = output
        with open(output, "w") as file:
            self.process = subprocess.Popen([str(word) for word in command], stdin=subprocess.DEVNULL, stdout=file, stderr=file)
        for _ in range(200):
            if self.process.poll() is not None:
                break
            with socket.socket() as probe:
                if probe.connect_ex(("127.0.0.1", port)) == 0:
                    return
            time.sleep(0.05)
        self.stop()
        raise AssertionError(f"{command[0]} does not listen: {output.read_text()}")

    def stop(self):
        if self.process.poll() is None:
            self.process.terminate()
        try:
            self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()

    def lines(self):
        return len(self.output.read_text().splitlines())

    def cpu_seconds(self):
        fields = pathlib.Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def start_octopair(folder, port, metrics_port):
    return Process([program, "serve", "--listen", f"127.0.0.1:{port}", "--tokens", files / "tokens", "--state", folder / "state",
                    "--threads", 1, "--max-objects", MAX_OBJECTS, "--metrics", f"127.0.0.1:{metrics_port}"],
                   port, folder / "octopair.log")


def substitute(text, values):
    """Replaces each key of `values` in the text. Throws: AssertionError if the text does not have the key."""
    for old, new in values.items():
        if old not in text:
            raise AssertionError(f"the configuration does not contain '{old}'")
        text = text.replace(old, str(new))
    return text


def start_nginx(folder, port, octopair_port, changes):
    nginx = find_program("nginx")
    text = substitute((CONFIGURATIONS / "nginx.conf").read_text(), {
        "/run/nginx.pid": folder / "nginx.pid",
        "/var/log/nginx/": f"{folder}/",
        "/etc/octopair/server.pem": files / "server.pem",
        "/etc/octopair/server.key": files / "server.key",
        "listen 7789": f"listen 127.0.0.1:{port}",
        "server 127.0.0.1:7788": f"server 127.0.0.1:{octopair_port}",
        **changes})
    (folder / "nginx.conf").write_text(text)
    return Process([nginx, "-e", folder / "error.log", "-p", folder, "-c", folder / "nginx.conf", "-g", "daemon off;"], port,
                   folder / "nginx.output")


def start_haproxy(folder, port, octopair_port, changes):
    haproxy = find_program("haproxy")
    (folder / "empty").mkdir()
    text = substitute((CONFIGURATIONS / "haproxy.cfg").read_text(), {
        "log /dev/log": f"log 127.0.0.1:{free_ports(1)[0]}",  # no program receives these datagrams
        "chroot /var/lib/haproxy": f"chroot {folder}/empty",
        "/etc/octopair/server-and-key.pem": files / "server-and-key.pem",
        "bind :7789": f"bind 127.0.0.1:{port}",
        "server octopair 127.0.0.1:7788": f"server octopair 127.0.0.1:{octopair_port}",
        **changes})
    if os.geteuid() != 0:  # only root may change the root folder and the user
        text = substitute(text, {f"chroot {folder}/empty": "", "user haproxy": f"user {pwd.getpwuid(os.getuid()).pw_name}",
                                 "group haproxy": f"group {grp.getgrgid(os.getgid()).gr_name}"})
    (folder / "haproxy.cfg").write_text(text)
    return Process([haproxy, "-db", "-f", folder / "haproxy.cfg"], port, folder / "haproxy.output")


class Stack:
    """octopair, with a proxy in front. `changes`: further replacements in the proxy's configuration."""

    def __init__(self, start_proxy, changes=None):
        self.folder = pathlib.Path(tempfile.mkdtemp(dir=files))
        self.folder.chmod(0o755)
        self.port, octopair_port, self.metrics_port = free_ports(3)
        self.octopair = start_octopair(self.folder, octopair_port, self.metrics_port)
        try:
            self.proxy = start_proxy(self.folder, self.port, octopair_port, changes or {})
        except BaseException:
            self.octopair.stop()
            raise

    def stop(self):
        self.proxy.stop()
        self.octopair.stop()

    def access(self, token="anna"):
        """Returns the options of a client for the proxy's certificate and its token."""
        return ["--tls-authority", files / "authority.pem", "--token-file", files / f"{token}.token"]

    def client(self, command, *arguments, token="anna"):
        """Runs a command of octopair through the proxy."""
        return run(program, command, *arguments, "--server", f"localhost:{self.port}", *self.access(token))

    def detect_command(self, objects, *arguments, token="anna"):
        return [program, "detect", files / f"{objects}.npy", "--quiet", "--engine", f"localhost:{self.port}", *arguments,
                *self.access(token)]

    def detect(self, objects, *arguments, token="anna"):
        return run(*self.detect_command(objects, *arguments, token=token))

    def start_detect(self, objects, *arguments):
        command = [str(word) for word in self.detect_command(objects, *arguments)]
        return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

    def attack(self, source=ATTACKER):
        """Returns a connection of an attacker."""
        connection = attacks.Connection(self.port, files / "authority.pem", source)
        connection.start()
        return connection

    def metric(self, name):
        found = re.search(rf"^{re.escape(name)} (\S+)$", metrics.page(self.metrics_port), re.MULTILINE)
        return float(found.group(1)) if found else 0.0


class ProxyTests:
    """Tests of one proxy. A derived class says which."""

    start_proxy = None           # function that starts the proxy
    certificate_changes = None   # function that returns the replacements that enable the commented part about client certificates
    passes_early_status = True   # whether clients get the reason of a call that octopair refuses during its upload
    max_of_address = None        # connections that the proxy accepts from an address; None: no limit

    @classmethod
    def setUpClass(cls):
        cls.stack = Stack(cls.start_proxy)
        cls.addClassCleanup(cls.stack.stop)

    def assert_detects(self, objects, stack=None):
        stack = stack or self.stack
        output = stack.folder / "pairs.npy"
        done = stack.detect(objects, "--output", output)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(output.read_bytes(), (files / f"{objects}.pairs.npy").read_bytes())

    def test_pairs_are_those_of_the_local_engine(self):
        self.assert_detects(SMALL)
        self.assert_detects(LARGE)

    def test_a_submitted_job_gives_its_pairs(self):
        done = self.stack.client("submit", files / f"{LARGE}.npy", "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        job, output = done.stdout.strip(), self.stack.folder / "submitted.npy"
        done = self.stack.client("status", job, "--wait", 60)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("done", done.stdout)
        done = self.stack.client("result", job, "--output", output, "--release", "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(output.read_bytes(), (files / f"{LARGE}.pairs.npy").read_bytes())

    def test_a_wrong_token_is_refused(self):
        done = self.stack.detect(SMALL, "--count-only", token="wrong")
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("does not accept this token", done.stderr)

    def test_a_client_needs_a_certificate_if_the_proxy_asks_for_one(self):
        stack = Stack(self.start_proxy, self.certificate_changes())
        self.addCleanup(stack.stop)
        with_certificate = ["--tls-certificate", files / "client.pem", "--tls-key", files / "client.key"]
        done = stack.detect(SMALL, "--count-only", *with_certificate)
        self.assertEqual(done.returncode, 0, done.stderr)
        calls = stack.metric("octopair_received_bytes_total")
        done = stack.detect(SMALL, "--count-only", "--patience", 1)
        self.assertNotEqual(done.returncode, 0, "a client without a certificate is served")
        self.assertEqual(stack.metric("octopair_received_bytes_total"), calls)

    def run_briefly(self, client, seconds):
        """Returns the status and the messages of a client that must end within some seconds."""
        try:
            _, messages = client.communicate(timeout=seconds)
        except subprocess.TimeoutExpired:
            client.kill()
            client.communicate()
            self.fail(f"the client with --patience 2 does not end within {seconds} s")
        return client.returncode, messages

    def test_a_refused_upload_ends(self):
        client = self.stack.start_detect(TOO_LARGE, "--count-only", "--patience", 2)
        status, messages = self.run_briefly(client, seconds=10)
        if self.passes_early_status:
            self.assertEqual(status, 5, messages)
            self.assertIn(f"at most {MAX_OBJECTS}", messages)
        else:
            self.assertEqual(status, 6, messages)

    def test_a_client_gives_up_if_octopair_is_gone(self):
        stack = Stack(self.start_proxy)
        self.addCleanup(stack.stop)
        for _ in range(10):
            client = stack.start_detect(LARGE, "--count-only", "--patience", 2)
            while client.poll() is None and stack.metric('octopair_jobs{state="uploading"}') == 0:
                pass
            if client.poll() is None:
                break
            client.communicate()  # the job has ended between two queries
        stack.octopair.process.kill()
        status, messages = self.run_briefly(client, seconds=10)
        self.assertEqual(status, 6, messages)

    def test_an_endless_header_is_cut(self):
        for is_admitted, kind in itertools.product([False, True], attacks.ENDLESS_HEADERS):
            with self.subTest(is_admitted=is_admitted, header=kind):
                connection = self.stack.attack()
                self.addCleanup(connection.close)
                if is_admitted:
                    self.assertIsNotNone(connection.call("/octopair.v1.Octopair/Describe", TOKEN))
                before = self.stack.octopair.cpu_seconds()
                sent = attacks.send_endless_header(connection, 3, attacks.ENDLESS_HEADERS[kind], most_bytes=64_000_000, seconds=10)
                self.assertIsNotNone(sent, "the proxy takes 64 MB of a header, or a header for 10 s")
                self.assertLess(sent, 6_000_000)
                time.sleep(0.3)
                self.assertLess(self.stack.octopair.cpu_seconds() - before, 0.2, "CPU seconds of octopair")

    def test_rapid_reset_does_not_reach_octopair(self):
        before, lines = self.stack.octopair.cpu_seconds(), self.stack.octopair.lines()
        calls = []

        def reset():
            calls.append(attacks.reset_rapidly(self.stack.port, files / "authority.pem", ATTACKER, WRONG_TOKEN, seconds=3))

        attackers = [threading.Thread(target=reset) for _ in range(4)]
        for attacker in attackers:
            attacker.start()
        time.sleep(1)
        try:
            begin = time.monotonic()
            self.assert_detects(SMALL)
            self.assertLess(time.monotonic() - begin, 5, "seconds that a client waits")
        finally:
            for attacker in attackers:
                attacker.join()
        self.assertGreater(sum(calls), 20_000, "the attack is too weak for a test")
        self.assertLess(self.stack.octopair.cpu_seconds() - before, 0.5, "CPU seconds of octopair")
        self.assertLess(self.stack.octopair.lines() - lines, 60, "lines in the log of octopair")

    def test_silent_connections_leave_room_for_clients(self):
        lines = self.stack.octopair.lines()
        silent = []
        self.addCleanup(lambda: [one.close() for one in silent])
        for i in range(500):
            try:
                one = socket.create_connection(("127.0.0.1", self.stack.port), timeout=2, source_address=(ATTACKER, 0))
                silent.append(one)
                if i % 2 == 1:
                    one.sendall(b"\x16\x03\x01")  # the first bytes of a TLS handshake
            except TimeoutError:
                break
            except OSError:  # the proxy has cut the connection
                pass
        encrypted = [self.stack.attack(OTHER_ATTACKER) for _ in range(20)]
        self.addCleanup(lambda: [one.close() for one in encrypted])
        begin = time.monotonic()
        self.assert_detects(SMALL)
        self.assertLess(time.monotonic() - begin, 5, "seconds that a client waits")
        if self.max_of_address is not None:
            self.assertLessEqual(sum(is_open(one) for one in silent), self.max_of_address)
        while time.monotonic() < begin + 15 and not all(one.is_closed() for one in encrypted):
            time.sleep(0.2)
        self.assertEqual(sum(not one.is_closed() for one in encrypted), 0, "connections without a call after 15 s")
        if self.max_of_address is None:
            self.assertEqual(sum(is_open(one) for one in silent), 0, "silent connections after 15 s")
        self.assertLess(self.stack.octopair.lines() - lines, 60, "lines in the log of octopair")

    def test_calls_of_other_services_do_not_reach_octopair(self):
        # HPACK's static table has the status 200 at 8 and 404 at 13. octopair answers calls that it does not have with 200.
        for path, status in [("/octopair.v1.Octopair/Describe", b"\x88"), ("/other.Service/Call", b"\x8d")]:
            with self.subTest(path=path):
                connection = self.stack.attack()
                self.addCleanup(connection.close)
                answer = connection.call(path, WRONG_TOKEN)
                self.assertIsNotNone(answer, "the proxy does not answer")
                self.assertIn(status, answer[:4])


def is_open(connection):
    connection.setblocking(False)
    try:
        return connection.recv(1) != b""
    except BlockingIOError:
        return True
    except OSError:
        return False


class Nginx(ProxyTests, unittest.TestCase):
    start_proxy = staticmethod(start_nginx)

    @staticmethod
    def certificate_changes():
        return {"#ssl_verify_client on;": "ssl_verify_client on;",
                "#ssl_client_certificate /etc/octopair/clients.pem;": f"ssl_client_certificate {files}/authority.pem;"}


class Haproxy(ProxyTests, unittest.TestCase):
    start_proxy = staticmethod(start_haproxy)
    passes_early_status = False
    max_of_address = 64

    @staticmethod
    def certificate_changes():
        return {"\n    bind ": "\n    # replaced: ", "\n    #bind ": "\n    bind ",
                "/etc/octopair/clients.pem": files / "authority.pem"}


def main():
    global program
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", default=program)
    arguments, rest = parser.parse_known_args()
    program = arguments.program and str(pathlib.Path(arguments.program).resolve())
    unittest.main(argv=[sys.argv[0], *rest], verbosity=2)


if __name__ == "__main__":
    main()
