#include "io/meshes/three_mf/three_mf_scene.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "io/meshes/three_mf/build_tree.hpp"
#include "io/meshes/three_mf/model.hpp"
#include "io/meshes/three_mf/package.hpp"

namespace octopair::io {

namespace {

using three_mf::Build;
using three_mf::Model;
using three_mf::Package;

/// Returns the short form of a unit of 3MF. Requires: the unit is one of 3MF.
std::string short_unit(std::string_view unit) {
    constexpr std::array<std::pair<std::string_view, const char*>, 6> units = {
        {{"micron", "µm"}, {"millimeter", "mm"}, {"centimeter", "cm"}, {"inch", "in"}, {"foot", "ft"}, {"meter", "m"}}};
    return std::find_if(units.begin(), units.end(), [&](const auto& known) { return known.first == unit; })->second;
}

std::vector<std::string> warnings_of(const Model& model, const Build& build) {
    std::vector<std::string> warnings = model.warnings();
    warnings.insert(warnings.end(), build.warnings.begin(), build.warnings.end());
    return warnings;
}

LoadedScene scene_of_package(Package& package, const SceneContent& content) {
    Model model(package, content.progress);
    Build build = make_build(model);
    LoadedScene scene = scene_of(build.placed, content, package.budget());
    scene.warnings = warnings_of(model, build);
    scene.not_read = std::move(build.not_read);
    scene.space = {UpAxis::z, short_unit(model.start().unit)};
    return scene;
}

}  // namespace

bool is_three_mf_ending(std::string_view ending) { return ending == ".3mf"; }

LoadedScene read_three_mf_scene(const std::string& path, const SceneContent& content, const std::stop_token& stop) {
    Package package(path, stop);
    return scene_of_package(package, content);
}

LoadedScene parse_three_mf_scene(const std::string& path, Buffer<std::byte> bytes, const SceneContent& content,
                                 const std::stop_token& stop) {
    Package package(path, std::move(bytes), stop);
    return scene_of_package(package, content);
}

shape::Mesh read_three_mf_mesh(const std::string& path, LoadedScene& scene, const std::stop_token& stop) {
    Package package(path, stop);
    Model model(package, {});
    const Build build = make_build(model);
    for (std::string& warning : warnings_of(model, build)) scene.warnings.push_back(std::move(warning));
    return whole_mesh_of(build.placed, package.budget());
}

std::string three_mf_version(const std::string& path) {
    Package package(path, {});
    const std::string start = package.find_start();
    const auto text = package.text_of(start, "the package");
    const std::string version = three_mf::parse_version(start, text, package.budget());
    return version.empty() ? "" : "core " + version;
}

}  // namespace octopair::io
