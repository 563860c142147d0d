"""Stands for the module `conan`: as much of Conan 2 as the recipe in packaging/conan uses.

Call `install()` before a recipe is imported. CMake runs with the packages of this machine in place of those of Conan. What Conan would
refuse raises an error, too: unknown options, unknown properties, requirements that no component has.
"""
import fnmatch
import os
import pathlib
import re
import shutil
import subprocess
import sys
import types

# Options of CMake for every build of the tests. They make the compiler commands equal to those of the presets, so ccache has them.
EXTRA = ["-DOCTOPAIR_WARNINGS_AS_ERRORS=ON"]


class InvalidConfiguration(Exception):
    pass


class Options:
    """Options of a recipe. Access to an unknown or removed option fails, except by *_safe."""

    def __init__(self, allowed, values):
        object.__setattr__(self, "allowed", dict(allowed))
        object.__setattr__(self, "values", dict(values))
        assert set(allowed) == set(values), "options and default_options differ"
        for name, value in values.items():
            assert value in allowed[name], f"{name}={value} is not allowed"

    def __getattr__(self, name):
        if name not in self.values:
            raise InvalidConfiguration(f"option '{name}' does not exist")
        return self.values[name]

    def __setattr__(self, name, value):
        assert value in self.allowed[name]
        self.values[name] = value

    def get_safe(self, name, default=None):
        return self.values.get(name, default)

    def rm_safe(self, name):
        self.values.pop(name, None)


class CppInfo:
    """What a package or a component gives to its users."""

    PROPERTIES = {"cmake_file_name", "cmake_target_name", "cmake_find_mode", "pkg_config_name"}

    def __init__(self):
        self.properties, self.libs, self.requires, self.defines, self.system_libs = {}, [], [], [], []
        self.includedirs, self.libdirs, self.bindirs = ["include"], ["lib"], ["bin"]

    def set_property(self, name, value):
        assert name in self.PROPERTIES, f"Conan has no property {name}"
        self.properties[name] = value


class Components(dict):
    def __missing__(self, name):
        self[name] = CppInfo()
        return self[name]


class ConanFile:
    """Base of a recipe. The folders are attributes that `prepare` sets."""

    options, default_options = {}, {}

    def prepare(self, recipe_folder, source_folder, build_folder, package_folder, **options):
        self.recipe_folder, self.source_folder = str(recipe_folder), str(source_folder)
        self.build_folder, self.package_folder = str(build_folder), str(package_folder)
        self.settings = types.SimpleNamespace(os="Linux", arch="x86_64", compiler="gcc", build_type="Release")
        self.options = Options(type(self).options, {**type(self).default_options, **options})
        self.references, self.tool_references, self.toolchain, self.properties = [], [], {}, {}
        self.cpp_info = CppInfo()
        self.cpp_info.components = Components()
        self.cpp = types.SimpleNamespace(build=types.SimpleNamespace(bindir=self.build_folder))
        self.environment = dict(os.environ)

    def requires(self, reference):
        assert re.fullmatch(r"[a-z0-9_+.-]+/(\[[^\]]+\]|[\w.]+)", reference), f"not a reference: {reference}"
        name = reference.partition("/")[0]
        assert name not in self.requirement_names(), f"duplicated requirement: {reference}"
        self.references.append(reference)

    def tool_requires(self, reference):
        self.tool_references.append(reference)

    def requirement_names(self):
        return [reference.partition("/")[0] for reference in self.references]

    def run(self, command, env=None):
        assert env == "conanrun"
        subprocess.run(command, shell=True, check=True, env=self.environment)


class CMakeToolchain:
    def __init__(self, recipe):
        self.recipe, self.cache_variables = recipe, {}

    def generate(self):
        self.recipe.toolchain = dict(self.cache_variables)


class CMakeDeps:
    def __init__(self, recipe):
        self.recipe, self.properties = recipe, {}

    def set_property(self, dependency, name, value):
        assert name in CppInfo.PROPERTIES, f"Conan has no property {name}"
        self.properties[dependency, name] = value

    def generate(self):
        self.recipe.properties = self.properties


class CMake:
    def __init__(self, recipe):
        self.recipe = recipe

    def configure(self):
        words = {True: "ON", False: "OFF"}
        options = [f"-D{name}={words.get(value, value)}" for name, value in self.recipe.toolchain.items()]
        shared = self.recipe.options.get_safe("shared")
        if shared is not None:
            options += [f"-DBUILD_SHARED_LIBS={words[shared]}", "-DCMAKE_INSTALL_LIBDIR=lib", *EXTRA]
        run_cmake("--fresh", "-S", self.recipe.source_folder, "-B", self.recipe.build_folder, "-G", "Ninja",
                  f"-DCMAKE_BUILD_TYPE={self.recipe.settings.build_type}", *options)

    def build(self):
        run_cmake("--build", self.recipe.build_folder)

    def install(self):
        run_cmake("--install", self.recipe.build_folder, "--prefix", self.recipe.package_folder)


def run_cmake(*arguments):
    """Runs CMake. Shows its output only if it fails."""
    done = subprocess.run(["cmake", *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if done.returncode:
        sys.exit(f"cmake {' '.join(arguments)}\n{done.stdout[-5000:]}")


def copy(_, pattern, src, dst, excludes=""):
    """Copies the files whose path below src matches a pattern, and not `excludes`. A * also matches slashes."""
    found = [path for path in pathlib.Path(src).glob(pattern.replace("*", "**/*"))
             if path.is_file() and not fnmatch.fnmatch(str(path.relative_to(src)), excludes)]
    assert found, f"no file {pattern} in {src}"
    for path in found:
        target = pathlib.Path(dst, path.relative_to(src))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(path, target)


def check_min_cppstd(_, least):
    assert least == 20


def install():
    """Makes `import conan` and its parts import this stand-in."""
    contents = {
        "conan": {"ConanFile": ConanFile},
        "conan.errors": {"ConanInvalidConfiguration": InvalidConfiguration},
        "conan.tools": {},
        "conan.tools.build": {"check_min_cppstd": check_min_cppstd, "can_run": lambda _: True},
        "conan.tools.cmake": {"CMake": CMake, "CMakeDeps": CMakeDeps, "CMakeToolchain": CMakeToolchain,
                              "cmake_layout": lambda _: None},
        "conan.tools.files": {"copy": copy, "rmdir": lambda _, path: shutil.rmtree(path, ignore_errors=True),
                              "rm": lambda _, pattern, folder: [path.unlink() for path in pathlib.Path(folder).glob(pattern)],
                              "load": lambda _, path: pathlib.Path(path).read_text(encoding="utf-8")},
    }
    for name, members in contents.items():
        sys.modules[name] = types.ModuleType(name)
        vars(sys.modules[name]).update(members)
