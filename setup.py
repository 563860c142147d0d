"""Builds the Python package with CMake (python/CMakeLists.txt). The version is that of CMakeLists.txt."""
import os
import pathlib
import re
import shutil

from skbuild import setup

root = pathlib.Path(__file__).parent
version = re.search(r"^project\(octopair VERSION ([\d.]+)", (root / "CMakeLists.txt").read_text(), re.MULTILINE)[1]

# All cores, unless the user says otherwise. SKBUILD_CONFIGURE_OPTIONS has further options of CMake.
os.environ.setdefault("CMAKE_BUILD_PARALLEL_LEVEL", str(os.cpu_count() or 1))
# The program of the wheel has the viewer if the tools that make its page are there.
viewer = "ON" if shutil.which("node") and shutil.which("npm") else "OFF"
setup(
    version=version,
    packages=["octopair"],
    package_dir={"": "python"},
    package_data={"octopair": ["py.typed", "*.pyi"]},
    include_package_data=False,
    zip_safe=False,
    cmake_args=["-DOCTOPAIR_WITH_PYTHON=ON", "-DOCTOPAIR_PYTHON_WHEEL=ON", "-DOCTOPAIR_BUILD_TESTS=OFF",
                "-DOCTOPAIR_WITH_ADAPTERS=OFF", "-DOCTOPAIR_WITH_C=OFF", "-DOCTOPAIR_WITH_SYSTEMD=OFF",
                "-DOCTOPAIR_SHARED_LIBS=OFF", f"-DOCTOPAIR_WITH_VIEWER={viewer}"],
    cmake_install_target="install_python",
)
