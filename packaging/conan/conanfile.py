"""Recipe of octopair for Conan 2.

    conan create packaging/conan --build=missing

The build is that of the project's CMakeLists.txt. An option of the recipe is an option of CMake (CMAKE_OPTIONS). A component is a
target of CMake with the same name: `find_package(octopair CONFIG REQUIRED)` gives octopair::octopair, octopair::pipeline and so on.
Only the component `program` has no target in CMake: it holds what the program alone needs.
"""
import os
import re

from conan import ConanFile
from conan.errors import ConanInvalidConfiguration
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy, load, rm, rmdir

required_conan_version = ">=2.0.9"

# Option of the recipe -> option of CMake.
CMAKE_OPTIONS = {
    "program": "OCTOPAIR_BUILD_PROGRAM",
    "meshes": "OCTOPAIR_WITH_MESHES",
    "pipeline": "OCTOPAIR_WITH_PIPELINE",
    "processes": "OCTOPAIR_WITH_PROCESSES",
    "mpi": "OCTOPAIR_WITH_MPI",
    "service": "OCTOPAIR_WITH_SERVICE",
    "systemd": "OCTOPAIR_WITH_SYSTEMD",
    "viewer": "OCTOPAIR_WITH_VIEWER",
    "adapters": "OCTOPAIR_WITH_ADAPTERS",
}
# Options of CMake that a package does not use, because nothing of these parts is installed for users of C++.
CMAKE_OFF = ["OCTOPAIR_WITH_C", "OCTOPAIR_WITH_PYTHON", "OCTOPAIR_WITH_IFC", "OCTOPAIR_WITH_STEP", "OCTOPAIR_BUILD_TESTS",
             "OCTOPAIR_BUILD_BENCHMARKS"]

# Option (None: always) -> packages. gRPC stands before protobuf and OpenSSL: it names exact versions, which the ranges then take.
REQUIREMENTS = {
    None: ["onetbb/[>=2021.9 <2023]", "highway/[>=1.0.3 <2]"],
    "pipeline": ["eigen/[>=3.4 <4]", "boost/[>=1.74 <2]"],
    "service": ["grpc/[>=1.54.3 <2]", "protobuf/[>=3.21 <7]", "openssl/[>=3 <4]", "xxhash/[>=0.8.1 <1]", "spdlog/[>=1.10 <2]",
                "nlohmann_json/[>=3.11 <4]", "prometheus-cpp/[>=1.1 <2]"],
    "program": ["cli11/[>=2.3 <3]", "fmt/[>=9]", "nlohmann_json/[>=3.11 <4]", "zlib/[>=1.2.13 <2]"],
    "meshes": ["assimp/[>=5.2 <6]", "expat/[>=2.5 <3]", "zlib/[>=1.2.13 <2]", "minizip/[>=1.2.13 <2]",
               "xxhash/[>=0.8.1 <1]"],
    "mpi": ["openmpi/[>=4.1 <6]"],
    "systemd": ["libsystemd/[>=252]"],
    "viewer": ["boost/[>=1.74 <2]", "zlib/[>=1.2.13 <2]", "nlohmann_json/[>=3.11 <4]"],
}
# Package or component -> name that the project's CMakeLists.txt uses, wherever the recipe of the package says something else.
CMAKE_FILES = {"onetbb": "TBB", "highway": "hwy", "eigen": "Eigen3", "boost": "Boost", "grpc": "gRPC", "protobuf": "Protobuf",
               "openssl": "OpenSSL", "spdlog": "spdlog", "nlohmann_json": "nlohmann_json", "prometheus-cpp": "prometheus-cpp",
               "cli11": "CLI11", "fmt": "fmt", "assimp": "assimp", "expat": "EXPAT", "openmpi": "MPI", "zlib": "ZLIB"}
CMAKE_TARGETS = {"onetbb::libtbb": "TBB::tbb", "highway::hwy": "hwy::hwy", "openmpi": "MPI::MPI_CXX"}

# Component -> option, or None, and what the component requires. The library of a component is octopair or octopair_COMPONENT.
LIBRARIES = {
    "octopair": (None, ["onetbb::libtbb", "highway::hwy"]),
    "pipeline": ("pipeline", ["octopair", "highway::hwy", "eigen::eigen", "boost::headers"]),
    "processes": ("processes", ["octopair"]),
    "mpi": ("mpi", ["octopair", "highway::hwy", "openmpi::openmpi"]),
    "client": ("service", ["octopair", "grpc::grpc++", "protobuf::libprotobuf", "openssl::crypto"]),
    "viewer": ("viewer", ["octopair", "zlib::zlib", "boost::headers", "nlohmann_json::nlohmann_json"]),
}
ADAPTERS = ["cgal", "fcl", "bullet"]
# What only the program uses, by option. Conan refuses a requirement that no component has.
PROGRAM_REQUIRES = {
    "program": ["cli11::cli11", "fmt::fmt", "nlohmann_json::nlohmann_json", "zlib::zlib"],
    "service": ["grpc::grpc++_reflection", "xxhash::xxhash", "spdlog::spdlog", "prometheus-cpp::prometheus-cpp-pull",
                "nlohmann_json::nlohmann_json"],
    "meshes": ["assimp::assimp", "expat::expat", "zlib::zlib", "minizip::minizip", "xxhash::xxhash"],
    "systemd": ["libsystemd::libsystemd"],
}


class OctopairConan(ConanFile):
    name = "octopair"
    description = "Every colliding pair among millions of moving 3D objects"
    license = "BSD-3-Clause"
    topics = ("collision-detection", "broad-phase", "octree", "geometry")
    package_type = "library"
    settings = "os", "arch", "compiler", "build_type"
    options = {"shared": [True, False], "fPIC": [True, False], **{name: [True, False] for name in CMAKE_OPTIONS}}
    default_options = {"shared": False, "fPIC": True, **{name: name not in ("mpi", "systemd", "viewer") for name in CMAKE_OPTIONS}}

    def set_version(self):
        text = load(self, os.path.join(self.recipe_folder, "..", "..", "CMakeLists.txt"))
        self.version = re.search(r"project\(octopair VERSION ([0-9.]+)", text)[1]

    def export_sources(self):
        root = os.path.join(self.recipe_folder, "..", "..")
        for pattern in ("CMakeLists.txt", "LICENSE", "cmake/*", "include/*", "src/*", "adapters/*", "packaging/*", "docs/octopair.1"):
            copy(self, pattern, src=root, dst=self.export_sources_folder)
        copy(self, "viewer/*", src=root, dst=self.export_sources_folder, excludes="viewer/node_modules/*")

    def config_options(self):
        if self.settings.os != "Linux":
            self.options.rm_safe("processes")
            self.options.rm_safe("systemd")

    def configure(self):
        if self.options.shared:
            self.options.rm_safe("fPIC")
        if not self.options.program:
            self.options.rm_safe("meshes")
            self.options.rm_safe("systemd")

    def layout(self):
        cmake_layout(self)

    def has(self, option):
        """Returns whether an option is on. None stands for what every package has."""
        return option is None or bool(self.options.get_safe(option))

    def requirements(self):
        for reference in dict.fromkeys(name for option, names in REQUIREMENTS.items() if self.has(option) for name in names):
            self.requires(reference)

    def build_requirements(self):
        self.tool_requires("cmake/[>=3.25]")
        if self.options.service:
            self.tool_requires("grpc/<host_version>")
            self.tool_requires("protobuf/<host_version>")

    def validate(self):
        check_min_cppstd(self, 20)
        if self.settings.os == "Windows":
            raise ConanInvalidConfiguration("octopair is not built for Windows")

    def generate(self):
        toolchain = CMakeToolchain(self)
        for option, variable in CMAKE_OPTIONS.items():
            toolchain.cache_variables[variable] = self.has(option)
        for variable in CMAKE_OFF:
            toolchain.cache_variables[variable] = False
        toolchain.cache_variables["OCTOPAIR_SHARED_LIBS"] = bool(self.options.shared)
        toolchain.cache_variables["OCTOPAIR_PACKAGE_BUILD"] = True
        toolchain.generate()
        dependencies = CMakeDeps(self)
        for package, name in CMAKE_FILES.items():
            dependencies.set_property(package, "cmake_file_name", name)
        for component, name in CMAKE_TARGETS.items():
            dependencies.set_property(component, "cmake_target_name", name)
        dependencies.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        copy(self, "LICENSE", src=self.source_folder, dst=os.path.join(self.package_folder, "licenses"))
        CMake(self).install()
        # The build makes static libraries, too.
        if self.options.shared:
            rm(self, "*.a", os.path.join(self.package_folder, "lib"))
        # Conan makes its own files of these kinds. The units of systemd name the folder of the build.
        for folder in ("cmake", "pkgconfig", "systemd"):
            rmdir(self, os.path.join(self.package_folder, "lib", folder))
        rmdir(self, os.path.join(self.package_folder, "share", "doc"))

    def package_info(self):
        self.cpp_info.set_property("cmake_file_name", "octopair")
        # Without this name, octopair::octopair would link all components.
        self.cpp_info.set_property("cmake_target_name", "octopair::all")
        for name, (option, requires) in LIBRARIES.items():
            if self.has(option):
                self.add_component(name, "octopair" if name == "octopair" else f"octopair_{name}", requires)
        for name in ADAPTERS if self.has("adapters") else []:
            self.add_component(name, None, ["octopair"])
        if self.has("processes"):
            worker = os.path.join(self.package_folder, "libexec", "octopair", "octopair-worker")
            self.cpp_info.components["processes"].defines = [f'OCTOPAIR_WORKER_PROGRAM="{worker}"']
        if self.has("program") or self.has("service"):
            requires = [name for option, names in PROGRAM_REQUIRES.items() if self.has(option) for name in names]
            self.add_component("program", None, list(dict.fromkeys(requires)))
            self.cpp_info.components["program"].bindirs = ["bin"]

    def add_component(self, name, library, requires):
        component = self.cpp_info.components[name]
        component.set_property("cmake_target_name", f"octopair::{name}")
        component.libs = [library] if library else []
        component.requires = requires
        if self.settings.os in ("Linux", "FreeBSD"):
            component.system_libs = ["m", "pthread"] if name == "octopair" else []
