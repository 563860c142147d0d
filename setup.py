"""Builds the Python package with CMake (python/CMakeLists.txt), in the folder build/wheel. The version is that of CMakeLists.txt.

Environment variables:

- OCTOPAIR_CMAKE_OPTIONS: further options of CMake.
- CMAKE_BUILD_PARALLEL_LEVEL: number of compilers that run at the same time. Default: one per core.

With ccache, the build takes objects that the same compiler commands made before. So it has the compiler options of the build in
build/release, if that exists.
"""
import contextlib
import functools
import os
import pathlib
import platform
import re
import shlex
import shutil
import stat
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

try:
    from setuptools.command.bdist_wheel import bdist_wheel
except ImportError:  # setuptools before 70.1
    try:
        from wheel.bdist_wheel import bdist_wheel
    except ImportError:
        raise SystemExit("setup.py: the Python package wheel is missing; on Debian, run scripts/setup python, and make the virtual "
                         "environment with --system-site-packages") from None

ROOT = pathlib.Path(__file__).resolve().parent
BUILD = ROOT / "build/wheel"
VERSION = re.search(r"^project\(octopair VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text(), re.MULTILINE)[1]

OLDEST_SYSTEMS = {"GLIBC": (2, 35), "GLIBCXX": (3, 4, 30), "CXXABI": (1, 3, 13), "GCC": (12, 0, 0)}
"""Versions of symbols that the C and C++ libraries of Ubuntu 22.04 and Debian 12 have. A wheel that needs no later ones has the tag
manylinux_2_35."""


class Progress:
    """Shows the progress of the build on the standard error of pip, which does not show what this program prints.

    On a terminal, the progress is behind pip's line "Building wheel for octopair ...", and the cursor returns to where pip left it. In a
    pipe, every tenth file is a line. Nothing is shown in a file, where pip would overwrite it; for `pip -q`, which shows nothing; and
    for `pip -v`, which shows all output."""

    def __init__(self):
        self.file, self.width = None, 0
        pip = pathlib.Path(f"/proc/{os.getppid()}")
        try:
            words = (pip / "cmdline").read_text(errors="replace").split("\0")
            quiet = {"PIP_QUIET", "PIP_VERBOSE"} & os.environ.keys()
            if "PIP_BUILD_TRACKER" in os.environ and not quiet and not any(re.fullmatch("-[qv]+|--quiet|--verbose", word) for word in words):
                # Without O_NONBLOCK, the build would wait for a program that does not read the pipe.
                self.open(os.open(pip / "fd/2", os.O_WRONLY | os.O_NOCTTY | os.O_NONBLOCK))
        except OSError:
            pass  # the system has no /proc, or pip's standard error is a socket

    def open(self, file):
        self.is_terminal = os.isatty(file)
        if self.is_terminal:
            # With less than 80 columns, the line would wrap. A terminal without a size has 0 columns.
            useful = not 0 < os.get_terminal_size(file).columns < 80
        else:
            useful = stat.S_ISFIFO(os.fstat(file).st_mode)
        if useful:
            self.file = file
        else:
            os.close(file)

    def show(self, done, total):
        text = f"compiling {done} of {total}"
        if self.file is None:
            return
        if self.is_terminal:
            self.width = max(self.width, len(text) + 2)
            self.write(f" {text} ".ljust(self.width) + "\b" * self.width)
        elif done % 10 == 0 and done > 0:
            self.write(f"octopair: {text}\n")

    def clear(self):
        if self.width > 0:
            self.write(" " * self.width + "\b" * self.width)

    def write(self, text):
        with contextlib.suppress(OSError):  # the reader has gone, or does not read
            os.write(self.file, text.encode())


def run(command, progress):
    """Runs a command through ccache, if that is installed (scripts/common.sh), and prints its output."""
    shell = ["bash", "-c", 'source "$0" && compile_through_ccache && exec "$@"', str(ROOT / "scripts/common.sh")]
    environment = {"CMAKE_BUILD_PARALLEL_LEVEL": str(len(os.sched_getaffinity(0))), **os.environ, "NINJA_STATUS": "[%f of %t] "}
    with subprocess.Popen(shell + command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace",
                          env=environment) as process:
        for line in process.stdout:
            print(line, end="", flush=True)
            counts = re.match(r"\[(\d+) of (\d+)\]", line)
            if counts:
                progress.show(int(counts[1]), int(counts[2]))
    progress.clear()
    if process.returncode:
        raise SystemExit(f"setup.py: failed with exit status {process.returncode}: {shlex.join(command)}")


def compiler_options():
    """Returns options of CMake that have an effect on the commands of the compiler, from the build in build/release.

    With other commands, ccache would not find the objects of that build."""
    try:
        cache = (ROOT / "build/release/CMakeCache.txt").read_text()
    except FileNotFoundError:
        return []
    found = dict(re.findall(r"^(CMAKE_CXX_FLAGS|OCTOPAIR_WARNINGS_AS_ERRORS):\w+=(.*)$", cache, re.MULTILINE))
    if "CXXFLAGS" in os.environ:
        found.pop("CMAKE_CXX_FLAGS", None)
    return [f"-D{name}={value}" for name, value in found.items()]


def cmake_options():
    # scikit-build, which built the package up to version 0.2, reads the first two variables.
    further = (os.environ.get(name, "") for name in ("CMAKE_ARGS", "SKBUILD_CONFIGURE_OPTIONS", "OCTOPAIR_CMAKE_OPTIONS"))
    return ["-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", f"-DPython_EXECUTABLE={sys.executable}", "-DOCTOPAIR_WITH_PYTHON=ON",
            "-DOCTOPAIR_PYTHON_WHEEL=ON", "-DOCTOPAIR_BUILD_TESTS=OFF", "-DOCTOPAIR_WITH_ADAPTERS=OFF", "-DOCTOPAIR_WITH_C=OFF",
            "-DOCTOPAIR_WITH_SYSTEMD=OFF", "-DOCTOPAIR_SHARED_LIBS=OFF", "-DOCTOPAIR_WITH_VIEWER=ON", *compiler_options(),
            *shlex.split(" ".join(further))]


class BuildWithCMake(build_ext):
    """Builds the modules and the programs, and puts them into the package with the libraries that they link."""

    def run(self):
        for program in ("cmake", "ninja", "bash"):
            if not shutil.which(program):
                raise SystemExit(f"setup.py: {program} is missing; on Debian, scripts/setup python installs all that the build needs")
        progress = Progress()
        run(["cmake", "--fresh", "-S", str(ROOT), "-B", str(BUILD), *cmake_options()], progress)
        run(["cmake", "--build", str(BUILD), "--target", "octopair_wheel"], progress)
        prefix = ROOT / "python" if self.inplace else pathlib.Path(self.build_lib)
        # Modules of an earlier build with other options must not stay.
        for file in (prefix / "octopair").glob("*.so"):
            file.unlink()
        for folder in ("bin", "lib"):
            shutil.rmtree(prefix / "octopair" / folder, ignore_errors=True)
        run(["cmake", "--install", str(BUILD), "--component", "python", "--strip", "--prefix", str(prefix.resolve())], progress)


def needed_versions(file):
    """Returns the versions of symbols that a program or library needs, as pairs of a name and numbers."""
    shown = subprocess.run(["readelf", "--version-info", "--wide", str(file)], capture_output=True, text=True, check=True).stdout
    shown = shown.replace("GLIBC_ABI_DT_RELR", "GLIBC_2.36")  # relocations that glibc reads since this version
    found = re.findall(rf"\b({'|'.join(OLDEST_SYSTEMS)})_([\d.]+)", shown)
    return {(name, tuple(map(int, version.split(".")))) for name, version in found}


class Wheel(bdist_wheel):
    """Names the oldest systems in the tag of the wheel, as PEP 600 says, if the wheel runs on these."""

    @functools.cache
    def get_tag(self):
        python, abi, system = super().get_tag()
        package = pathlib.Path(self.get_finalized_command("build").build_lib) / "octopair"
        files = [file for file in package.rglob("*") if file.is_file() and file.read_bytes()[:4] == b"\x7fELF"]
        needed = [(name, version, file.name) for file in files for name, version in sorted(needed_versions(file))]
        later = [row for row in needed if row[1] > OLDEST_SYSTEMS[row[0]]]
        for name, version, file in later:
            print(f"setup.py: {file} needs {name}_{'.'.join(map(str, version))}, so the wheel is for systems like this one only")
        # On a system with an earlier glibc, pip would refuse the tag, although the system built the wheel.
        c_library, version = platform.libc_ver()
        if c_library == "glibc" and tuple(map(int, version.split("."))) >= OLDEST_SYSTEMS["GLIBC"] and not later:
            system = re.sub("^linux_", "manylinux_2_35_", system)
        return python, abi, system


setup(
    version=VERSION,
    packages=["octopair"],
    package_dir={"": "python"},
    package_data={"octopair": ["py.typed", "*.pyi"]},
    include_package_data=False,
    zip_safe=False,
    ext_modules=[Extension("octopair._core", [])],
    cmdclass={"build_ext": BuildWithCMake, "bdist_wheel": Wheel},
    options={"build": {"build_base": str(BUILD / "setuptools")}},
)
