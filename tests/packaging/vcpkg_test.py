#!/usr/bin/env python3
"""Follows the port for vcpkg with stand-ins for its functions (vcpkg_port.cmake): manifest, build, installed files, and users.

    vcpkg_test.py ROOT BUILD VERSION

ROOT: the project. BUILD: a folder for the build, which stays for the next run. VERSION: the version of the project.
"""
import json
import os
import pathlib
import re
import sys
import tempfile

from conan_stand_in import run_cmake

# Fields of vcpkg.json, as the documentation of vcpkg lists them.
MANIFEST = {"$schema", "name", "version", "version-semver", "version-date", "version-string", "port-version", "maintainers",
            "summary", "description", "homepage", "documentation", "license", "builtin-baseline", "dependencies", "overrides",
            "features", "default-features", "supports"}
FEATURE = {"description", "dependencies", "supports", "license"}
DEPENDENCY = {"name", "features", "host", "default-features", "platform", "version>="}
# Ports that vcpkg has.
PORTS = {"highway", "tbb", "vcpkg-cmake", "vcpkg-cmake-config", "grpc", "protobuf", "openssl", "xxhash", "spdlog", "cli11", "fmt",
         "nlohmann-json", "assimp", "expat", "minizip", "prometheus-cpp", "mpi", "boost-asio", "boost-beast", "boost-headers", "boost-multiprecision", "zlib", "eigen3", "libsystemd", "octopair"}
IDENTIFIER = re.compile(r"[a-z0-9]+(-[a-z0-9]+)*")
PLATFORM = re.compile(r"!?\(?(windows|linux|osx|static|x64|arm64)\)?([&|] *!?\(?(windows|linux|osx|static|x64|arm64)\)?)*")


def check_platform(value):
    assert PLATFORM.fullmatch(value), f"not a platform expression: {value}"


def check_dependency(dependency, features):
    fields = {"name": dependency} if isinstance(dependency, str) else dependency
    assert set(fields) <= DEPENDENCY, f"a dependency has no field {set(fields) - DEPENDENCY}"
    assert fields["name"] in PORTS, f"vcpkg has no port {fields['name']}"
    if fields["name"] == "octopair":
        assert set(fields["features"]) <= features, f"the port has no feature {fields['features']}"
        assert fields["default-features"] is False
    for name in fields.get("features", []):
        assert IDENTIFIER.fullmatch(name), f"not a name of a feature: {name}"
    if "platform" in fields:
        check_platform(fields["platform"])


def check_manifest(manifest, version):
    """Checks vcpkg.json against the fields that vcpkg knows. Returns the names of its features."""
    assert set(manifest) <= MANIFEST, f"vcpkg.json has no field {set(manifest) - MANIFEST}"
    assert manifest["version"] == version, f"vcpkg.json has version {manifest['version']}, the project {version}"
    assert IDENTIFIER.fullmatch(manifest["name"]) and manifest["license"] == "BSD-3-Clause"
    features = manifest["features"]
    for item in [*features, *manifest["default-features"]]:
        fields = {"name": item} if isinstance(item, str) else item
        assert set(fields) <= {"name", "platform"} and fields["name"] in features, f"not a feature: {item}"
        assert IDENTIFIER.fullmatch(fields["name"]), f"not a name of a feature: {item}"
        check_platform(fields.get("platform", "linux"))
    for name, feature in features.items():
        assert set(feature) <= FEATURE and feature["description"], f"feature {name}: unknown fields, or no description"
    for owner in (manifest, *features.values()):
        for dependency in owner.get("dependencies", []):
            check_dependency(dependency, set(features))
        if "supports" in owner:
            check_platform(owner["supports"])
    return set(features)


def check_options(portfile, root, features):
    """Checks that the portfile maps each feature to an option of CMakeLists.txt, and sets all options that change what is built."""
    known = set(re.findall(r"^option\((OCTOPAIR_\w+)", (root / "CMakeLists.txt").read_text(encoding="utf-8"), re.MULTILINE))
    mapped = dict(re.findall(r"^ +([a-z]+) (OCTOPAIR_\w+)", portfile, re.MULTILINE))
    assert set(mapped) == features, f"features of portfile.cmake: {set(mapped)}, of vcpkg.json: {features}"
    named = set(mapped.values()) | set(re.findall(r"-D(OCTOPAIR_\w+)", portfile))
    assert named <= known, f"CMakeLists.txt has no option {named - known}"
    parts = {name for name in known if name.startswith("OCTOPAIR_WITH_")} | {"OCTOPAIR_BUILD_PROGRAM"}
    assert parts <= named, f"portfile.cmake does not set {parts - named}"


def check_package(package):
    """Checks what vcpkg checks after a build, as far as this port can break it."""
    for path in ("include/octopair/octopair.hpp", "share/octopair/octopair-config.cmake", "share/octopair/copyright",
                 "share/octopair/usage", "tools/octopair/octopair", "tools/octopair/octopair-worker"):
        assert (package / path).is_file(), f"{path} is not in the package"
    for path in ("bin", "libexec", "lib/cmake", "lib/systemd", "share/man", "share/doc"):
        assert not (package / path).exists(), f"{path} is in the package"
    for path in (package / "share/octopair").glob("*.cmake"):
        assert str(package) not in path.read_text(encoding="utf-8"), f"{path.name} names the folder of the build"
    usage = (package / "share/octopair/usage").read_text(encoding="utf-8")
    targets = "".join(path.read_text(encoding="utf-8") for path in (package / "share/octopair").glob("*.cmake"))
    for name in re.findall(r"octopair::(\w+)", usage):
        assert name == "mpi" or f"add_library(octopair::{name} " in targets, f"usage names octopair::{name}, which the package lacks"


def use_package(root, package, work):
    """Builds and runs users of the package, which has moved since its build."""
    moved = package.rename(work / "installed")
    for number, (target, option) in enumerate({"consumer": None, "process_consumer": "CONSUMER_WITH_PROCESSES",
                                               "pipeline_consumer": "CONSUMER_WITH_PIPELINE",
                                               "client_consumer": "CONSUMER_WITH_CLIENT",
                                               "viewer_consumer": "CONSUMER_WITH_VIEWER"}.items()):
        build = work / f"user{number}"
        run_cmake("-S", str(root / "tests/install/consumer"), "-B", str(build), "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Debug",
                  f"-DCMAKE_PREFIX_PATH={moved}", *([f"-D{option}=ON"] if option else []))
        run_cmake("--build", str(build), "--target", target)
        # The client needs a server, so it is only built here.
        assert target == "client_consumer" or os.system(f"'{build}/{target}'") == 0, f"{target} failed"
    assert os.system(f"'{moved}/tools/octopair/octopair' info") == 0


def main():
    root, build, version = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]), sys.argv[3]
    port = root / "packaging/vcpkg/octopair"
    features = check_manifest(json.loads((port / "vcpkg.json").read_text(encoding="utf-8")), version)
    check_options((port / "portfile.cmake").read_text(encoding="utf-8"), root, features)
    os.environ.pop("OCTOPAIR_WORKER", None)
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        package = work / "package"
        run_cmake(f"-DPORTFILE={port}/portfile.cmake", f"-DBUILD={build}", f"-DPACKAGE={package}",
                  f"-DFEATURES={';'.join(sorted(features - {'mpi', 'systemd'}))}", "-P",
                  str(pathlib.Path(__file__).with_name("vcpkg_port.cmake")))
        check_package(package)
        use_package(root, package, work)
    print("the port for vcpkg builds a package that works")


if __name__ == "__main__":
    main()
