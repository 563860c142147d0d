"""The settings of these tests: the program under test and the protocol file. The command line or the environment gives them."""
import argparse
import functools
import os
import pathlib
import shutil
import sys

SERVER_ENVIRONMENT = dict(os.environ)
os.environ["GRPC_ENABLE_FORK_SUPPORT"] = "0"     # gRPC's handlers of fork() can deadlock; a forked process never uses gRPC here
os.environ.setdefault("GRPC_VERBOSITY", "NONE")  # gRPC of the clients would report each handshake that fails as intended
# The server uses the implementation in C++. The implementation in Python is independent, and prints nothing.
os.environ.setdefault("PROTOCOL_BUFFERS_PYTHON_IMPLEMENTATION", "python")
SOURCE_TREE = pathlib.Path(__file__).resolve().parents[3]


class _Paths:
    program = os.environ.get("OCTOPAIR_PROGRAM", "octopair")
    proto = os.environ.get("OCTOPAIR_PROTO", str(SOURCE_TREE / "src/service/protocol/octopair.proto"))


def parser(description):
    """Returns a parser of command lines with the options --program and --proto."""
    result = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    result.add_argument("--program", default=_Paths.program, help="the program octopair (or OCTOPAIR_PROGRAM)")
    result.add_argument("--proto", default=_Paths.proto, help="the file octopair.proto (or OCTOPAIR_PROTO)")
    return result


def parse(arguments):
    """Reads the command line with a parser of parser(). Returns its options, and the arguments for unittest."""
    options, rest = arguments.parse_known_args()
    if shutil.which(options.program) is None:
        arguments.error(f"no program {options.program}: give --program PATH, or set OCTOPAIR_PROGRAM")
    _Paths.program, _Paths.proto = options.program, options.proto
    return options, [sys.argv[0], *rest]


def parse_without_program(arguments):
    """Reads the command line of a program that needs no server program. Returns its options."""
    options = arguments.parse_args()
    _Paths.proto = options.proto
    return options


def program():
    """Returns the path of the program under test."""
    return _Paths.program


def proto():
    """Returns the path of octopair.proto."""
    return pathlib.Path(_Paths.proto).resolve()


@functools.lru_cache(maxsize=None)
def is_sanitized():
    """Returns whether the program is built with AddressSanitizer, which takes memory and time."""
    try:
        return b"__asan_init" in pathlib.Path(program()).read_bytes()
    except OSError:
        return False
