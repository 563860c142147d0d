"""A server under test: `octopair serve` as a process, in a temporary folder with a token file and a state folder."""
import os
import pathlib
import re
import shutil
import signal
import subprocess
import tempfile
import threading
import time

import settings

# Begin of a line of the server, or of gRPC in the server.
LOG_LINE = re.compile(r"\d{4}-\d\d-\d\dT[\d:.]+Z (debug|info|warning|error) |[EIWD]\d{4} ")
POLITE = [f"polite{i}" for i in range(20)]
TOKENS = {name: f"{name}-0123456789abcdef" for name in ("anna", "berta", "greedy", *POLITE)}


def wait_until(predicate, seconds=60.0, interval=0.02):
    """Polls until the predicate is true, for `seconds` at most. Returns its last value."""
    end = time.monotonic() + seconds
    while not (value := predicate()) and time.monotonic() < end:
        time.sleep(interval)
    return value


class MemoryWatch:
    """Records the greatest resident memory of a server while a `with` block runs: `most`, in bytes."""

    def __init__(self, server, interval=0.05):
        self._server, self._interval, self._over = server, interval, threading.Event()
        self.most = server.resident_bytes()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._over.set()
        self._thread.join()

    def _run(self):
        while not self._over.wait(self._interval) and self._server.lives():
            self.most = max(self.most, self._server.resident_bytes())


class Server:
    """A running server.

    options     further options of `octopair serve`
    address     where the server listens; "unix" means a socket in the temporary folder
    tokens      whether clients need a token of TOKENS
    state       whether the server has a state folder
    open_files  limit on open files of the process (ulimit -n)
    """

    def __init__(self, *options, address="127.0.0.1:0", tokens=True, state=True, open_files=None):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="octopair_"))
        self.state = self.folder / "state"
        self.state.mkdir(mode=0o700)
        self.log_file = self.folder / "log"
        self.texts = []  # everything that the server has sent to clients of this process
        self._open_files = open_files
        self._process = None
        self._log_begin = 0
        self.last_log = ""
        self._options = [*(["--state", str(self.state)] if state else []), *map(str, options)]
        if tokens:
            self._options += ["--tokens", str(self._write_tokens())]
        self.address = f"unix:{self.folder}/socket" if address == "unix" else address
        try:
            self.start()
        except BaseException:
            self.stop()
            raise

    def _write_tokens(self):
        path = self.folder / "tokens"
        path.touch(mode=0o600)
        path.write_text("".join(f"{name} {token}\n" for name, token in TOKENS.items()), encoding="ascii")
        return path

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()

    def _command(self):
        command = [settings.program(), "serve", "--listen", self.address, *self._options]
        if self._open_files is None:
            return command
        return ["sh", "-c", f'ulimit -n {self._open_files} && exec "$@"', "sh", *command]

    def start(self):
        """Starts the process, and waits until it listens. Requires: no process runs."""
        self.spawn()
        self.wait_until_started()

    def spawn(self):
        """Starts the process. Requires: no process runs."""
        self._log_begin = self.log_file.stat().st_size if self.log_file.exists() else 0
        with open(self.log_file, "ab") as log:
            self._process = subprocess.Popen(self._command(), stdin=subprocess.DEVNULL, stdout=log, stderr=log,
                                             env=settings.SERVER_ENVIRONMENT)

    def wait_until_started(self):
        """Waits until the process listens. Raises RuntimeError if it ends before."""
        def started():
            return re.search(r" started address=(\S+)", self.log(self._log_begin))
        wait_until(lambda: not self.lives() or started())
        if not self.lives() or not started():
            raise RuntimeError(f"the server did not start: {self.log(self._log_begin)}")
        self.address = started().group(1).strip('"')

    def lives(self):
        """Returns whether the process runs."""
        return self._process is not None and self._process.poll() is None

    def exit_status(self):
        """Returns the exit status, negative for a signal; None while the process runs."""
        return self._process.poll()

    def kill(self):
        """Kills the process (SIGKILL) and waits for its end."""
        self._process.kill()
        self._process.wait()

    def stop(self):
        """Ends the server as a supervisor does, and removes its folder. `last_log` is then its log."""
        for seconds in (5 if settings.is_sanitized() else 0.5, 1):  # the second signal ends the server at once
            if self.lives():
                self._process.send_signal(signal.SIGTERM)
                wait_until(lambda: not self.lives(), seconds)
        if self.lives():
            self.kill()
        self.last_log = self.log()
        shutil.rmtree(self.folder, ignore_errors=True)

    def log(self, begin=0):
        """Returns the text of the log from byte `begin` on."""
        return self.log_file.read_bytes()[begin:].decode(errors="replace") if self.log_file.exists() else ""

    def resident_bytes(self):
        """Returns the resident memory of the process, in bytes."""
        text = pathlib.Path(f"/proc/{self._process.pid}/statm").read_text(encoding="ascii")
        return int(text.split()[1]) * os.sysconf("SC_PAGESIZE")

    def open_files(self):
        """Returns the number of open files of the process."""
        return len(os.listdir(f"/proc/{self._process.pid}/fd"))

    def broken_log_lines(self):
        """Returns the lines of the log that neither the server nor gRPC begins: parts of texts from clients."""
        return [line for line in self.log().splitlines() if not LOG_LINE.match(line)]

    def leaked_texts(self):
        """Returns the texts sent to clients that contain a path of the server."""
        paths = [str(self.state).encode(), str(self.folder / "tokens").encode()]
        return [text for text in self.texts if any(path in text for path in paths)]
