#!/usr/bin/env python3
"""Follows the recipe for Conan with a stand-in for Conan: source, build, package, and the test package.

    conan_test.py ROOT BUILD VERSION

ROOT: the project. BUILD: a folder for the build, which stays for the next run. VERSION: the version of the project.

The recipe must name options that CMakeLists.txt has, and all of them. Its components must be the targets that CMake exports. The
test package must build and run with the names of package_info alone.
"""
import importlib.util
import os
import pathlib
import re
import shutil
import sys
import tempfile

import conan_stand_in

# What the packages of ConanCenter name their targets, and the find_package call that makes the same target on this machine.
TARGETS = {
    "onetbb::libtbb": ("TBB::tbb", "TBB"), "highway::hwy": ("hwy::hwy", "hwy"), "eigen::eigen": ("Eigen3::Eigen", "Eigen3 CONFIG"),
    "boost::headers": ("Boost::headers", "Boost CONFIG COMPONENTS headers"), "grpc::grpc++": ("gRPC::grpc++", "gRPC CONFIG"),
    "protobuf::libprotobuf": ("protobuf::libprotobuf", "Protobuf"), "openssl::crypto": ("OpenSSL::Crypto", "OpenSSL"),
    "openmpi::openmpi": ("MPI::MPI_CXX", "MPI COMPONENTS CXX"), "zlib::zlib": ("ZLIB::ZLIB", "ZLIB"),
    "nlohmann_json::nlohmann_json": ("nlohmann_json::nlohmann_json", "nlohmann_json"),
}
# Packages of ConanCenter.
CENTER = {"onetbb", "highway", "eigen", "boost", "grpc", "protobuf", "openssl", "xxhash", "spdlog", "cli11", "fmt", "nlohmann_json",
          "assimp", "expat", "prometheus-cpp", "openmpi", "libsystemd", "zlib", "minizip"}


def load_recipe(path):
    spec = importlib.util.spec_from_file_location("recipe", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    recipes = [item for item in vars(module).values()
               if isinstance(item, type) and issubclass(item, conan_stand_in.ConanFile) and item is not conan_stand_in.ConanFile]
    return module, recipes[0]


def check_options(module, root):
    """Checks that the recipe sets every option of CMakeLists.txt that changes what is built, and no other."""
    known = set(re.findall(r"^option\((OCTOPAIR_\w+)", (root / "CMakeLists.txt").read_text(encoding="utf-8"), re.MULTILINE))
    named = set(module.CMAKE_OPTIONS.values()) | set(module.CMAKE_OFF)
    assert named <= known, f"CMakeLists.txt has no option {named - known}"
    parts = {name for name in known if name.startswith("OCTOPAIR_WITH_")} | {"OCTOPAIR_BUILD_PROGRAM"}
    assert parts <= named, f"the recipe does not set {parts - named}"
    assert set(module.CMAKE_OPTIONS) <= set(module.OctopairConan.options)


def check_names(module, root):
    """Checks the names of packages against those that the project looks for, and the references against ConanCenter."""
    lists = "".join(path.read_text(encoding="utf-8") for path in root.glob("src/**/CMakeLists.txt"))
    wanted = set(re.findall(r"find_package\((\S+)", lists))
    for package, name in module.CMAKE_FILES.items():
        assert name in wanted, f"the project does not look for {name}, the name of {package}"
    assert wanted <= set(module.CMAKE_FILES.values()), f"no package gives {wanted - set(module.CMAKE_FILES.values())}"
    for references in module.REQUIREMENTS.values():
        for reference in references:
            assert reference.partition("/")[0] in CENTER, f"ConanCenter has no package {reference}"


def prepare(recipe_type, root, build, package, **options):
    """Runs a recipe up to `generate`."""
    recipe = recipe_type()
    recipe.prepare(root / "packaging/conan", root, build, package, **options)
    recipe.set_version()
    recipe.config_options()
    recipe.configure()
    recipe.layout()
    recipe.requirements()
    recipe.build_requirements()
    recipe.validate()
    recipe.generate()
    return recipe


def check_requirements(recipe):
    """Makes the check of Conan: each requirement is one of a component, and the other way round."""
    recipe.package_info()
    used = {name.partition("::")[0] for component in recipe.cpp_info.components.values() for name in component.requires
            if "::" in name}
    required = set(recipe.requirement_names())
    assert used == required, f"required, but of no component: {required - used}; not required: {used - required}"
    for name, component in recipe.cpp_info.components.items():
        inner = {other for other in component.requires if "::" not in other}
        assert inner <= set(recipe.cpp_info.components), f"{name} requires unknown components: {inner}"


def check_every_option(module, recipe_type, root):
    """Turns each option off and on, without a build."""
    for option, variable in module.CMAKE_OPTIONS.items():
        for value in (True, False):
            recipe = prepare(recipe_type, root, root, root, **{option: value})
            check_requirements(recipe)
            assert recipe.toolchain[variable] is value, f"{option}={value} does not set {variable}"
    bare = prepare(recipe_type, root, root, root, **{option: False for option in module.CMAKE_OPTIONS})
    check_requirements(bare)
    assert bare.requirement_names() == ["onetbb", "highway"]


def exported_targets(build):
    """Returns the libraries that CMake exports, and the targets that each of them links."""
    found = {}
    for path in pathlib.Path(build).glob("**/CMakeFiles/Export/*/octopair_*.cmake"):
        text = path.read_text(encoding="utf-8")
        for name in re.findall(r"add_library\(octopair::(\w+)", text):
            properties = re.search(rf"set_target_properties\(octopair::{name} PROPERTIES\n(.*?)\n\)", text, re.DOTALL)
            links = re.search(r'INTERFACE_LINK_LIBRARIES "(.*)"', properties[1] if properties else "")
            found[name] = set(re.findall(r"\w+::[\w+]+", links[1] if links else ""))
    # octopair::processes is octopair::process_engine with the path of the worker program.
    found["processes"] = found.pop("process_engine")
    return found


def check_package(recipe, package):
    """Compares the installed files with package_info."""
    components = recipe.cpp_info.components
    libraries = {re.sub(r"^lib|\.(a|so[.\d]*)$", "", path.name) for path in (package / "lib").iterdir() if path.is_file()}
    named = {library for component in components.values() for library in component.libs}
    assert libraries == named, f"libraries of no component: {libraries - named}; not installed: {named - libraries}"
    exported = exported_targets(recipe.build_folder)
    assert set(exported) == set(components) - {"program"}, f"CMake exports {set(exported)}"
    for name, links in exported.items():
        declared = {TARGETS[other][0] if "::" in other else f"octopair::{other}" for other in components[name].requires}
        # Headers that only the library's sources include are a requirement, but not a link.
        assert declared - {"Eigen3::Eigen", "Boost::headers", "nlohmann_json::nlohmann_json"} == links, f"{name} requires {declared}, in CMake {links}"
    for define in components["processes"].defines:
        assert pathlib.Path(define.split('"')[1]).is_file(), f"{define}: no such file"
    for path in ("licenses/LICENSE", "bin/octopair", "include/octopair/octopair.hpp", "include/octopair/version.hpp"):
        assert (package / path).is_file(), f"{path} is not in the package"
    assert not (package / "lib/cmake").exists()


def config_of(recipe, package):
    """Returns the file octopair-config.cmake that Conan would make of package_info."""
    searches, targets = [], []
    for name, component in recipe.cpp_info.components.items():
        if name == "program":
            continue
        links = list(component.system_libs)
        for required in component.requires:
            target, search = TARGETS[required] if "::" in required else (f"octopair::{required}", None)
            links.append(target)
            searches += [f"find_package({search} REQUIRED)"] if search else []
        target = component.properties["cmake_target_name"]
        defines = ";".join(component.defines).replace('"', '\\"')
        location = "".join(f' IMPORTED_LOCATION "{package}/lib/lib{library}.a"' for library in component.libs)
        targets.append(f"add_library({target} {'UNKNOWN' if location else 'INTERFACE'} IMPORTED)\n"
                       f'set_target_properties({target} PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "{package}/include"\n'
                       f'    INTERFACE_COMPILE_DEFINITIONS "{defines}" INTERFACE_COMPILE_FEATURES cxx_std_20\n'
                       f'    INTERFACE_LINK_LIBRARIES "{";".join(links)}"{location})')
    return "\n".join(searches + targets) + "\n"


def run_test_package(recipe, root, package, work):
    """Builds and runs the test package."""
    (work / "generated").mkdir()
    (work / "generated/octopair-config.cmake").write_text(config_of(recipe, package), encoding="utf-8")
    _, test_type = load_recipe(root / "packaging/conan/test_package/conanfile.py")
    test = test_type()
    folder = root / "packaging/conan/test_package"
    test.prepare(folder, folder, work / "test", work / "none")
    test.tested_reference_str = f"{recipe.name}/{recipe.version}"
    test.dependencies = {"octopair": recipe}
    test.environment["PATH"] = f"{package}/bin:{os.environ['PATH']}"
    test.environment["LD_LIBRARY_PATH"] = f"{package}/lib"
    test.toolchain = {"octopair_DIR": str(work / "generated")}
    test.requirements()
    test.layout()
    test.build()
    test.test()


def check_exported(root, sources):
    """Configures the exported sources, and compares their folders with those of the project."""
    for folder in ("include", "src", "adapters", "cmake", "packaging", "viewer"):
        wanted = {path.relative_to(root) for path in (root / folder).rglob("*") if path.is_file() and not {"__pycache__", "node_modules"} & set(path.parts)}
        missing = [str(path) for path in wanted if not (sources / path).is_file()]
        assert not missing, f"not exported: {missing}"
    conan_stand_in.run_cmake("-S", str(sources), "-B", str(sources.parent / "configured"), "-G", "Ninja",
                             "-DOCTOPAIR_BUILD_TESTS=OFF", "-DOCTOPAIR_WITH_C=OFF", "-DOCTOPAIR_WITH_MPI=OFF")


def main():
    root, build, version = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]), sys.argv[3]
    conan_stand_in.install()
    module, recipe_type = load_recipe(root / "packaging/conan/conanfile.py")
    check_options(module, root)
    check_names(module, root)
    check_every_option(module, recipe_type, root)
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        exporter = recipe_type()
        exporter.prepare(root / "packaging/conan", root, build, work)
        exporter.export_sources_folder = str(work / "sources")
        exporter.export_sources()
        package = work / "package"
        recipe = prepare(recipe_type, root, build, package, viewer=True)
        assert recipe.version == version, f"the recipe has version {recipe.version}, the project {version}"
        check_exported(root, work / "sources")
        # CMake leaves exports of an earlier build that no longer exist.
        for stale in build.glob("**/CMakeFiles/Export"):
            shutil.rmtree(stale)
        recipe.build()
        recipe.package()
        recipe.package_info()
        check_package(recipe, package)
        run_test_package(recipe, root, package, work)
    print("the recipe for Conan builds a package that works")


if __name__ == "__main__":
    main()
