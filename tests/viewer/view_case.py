"""Tests of `octopair view` in a folder of their own: running the program, and reading its binary arrays."""
import argparse
import array
import csv
import io
import os
import subprocess
import sys
import tempfile
import unittest

from view_process import ViewProcess, WebSocket


def numbers(code, data):
    values = array.array(code)
    values.frombytes(data)
    return list(values)


def pairs_in(data):
    values = numbers('I', data)
    return list(zip(values[::2], values[1::2]))


class InFolder(unittest.TestCase):
    """A test with a folder of its own, and the program that main() got."""

    program = ''

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, name):
        return os.path.join(self.folder, name)

    def view(self, *arguments, **options):
        return ViewProcess(self.program, arguments, **options)

    def assert_web_socket(self, view, status, **options):
        """Opens a WebSocket with options of WebSocket(), and checks the status of the answer."""
        with WebSocket(view, **options) as web_socket:
            self.assertEqual(web_socket.status, status, options)

    def run_program(self, *arguments, environment=None):
        return subprocess.run([self.program, *arguments], capture_output=True, text=True, timeout=20, check=False,
                              env={**os.environ, **(environment or {})})

    def detected(self, path, *arguments):
        done = self.run_program('detect', path, '--quiet', *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return list(csv.DictReader(io.StringIO(done.stdout)))


def relative_rows(data, origin):
    """Returns the absolute coordinates of rows of boxes."""
    values = numbers('f', data)
    return [[values[i + k] + origin[k % 3] for k in range(6)] for i in range(0, len(values), 6)]


def main(description):
    """Runs the tests of the calling script: --program PATH [CLASS[.TEST]...]"""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--program', required=True)
    known, rest = parser.parse_known_args()
    InFolder.program = known.program
    unittest.main(argv=[sys.argv[0], *rest])
