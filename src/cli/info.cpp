// octopair info: prints version, build, engines and instruction set, or what files hold.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "cli/command/interrupt.hpp"
#include "cli/command/option_values.hpp"
#include "cli/detect/pipeline_options.hpp"
#include "cli/engine_choice.hpp"
#include "cli/input/input_set.hpp"
#include "cli/subcommands.hpp"
#include "io/boxes/npy.hpp"
#include "io/files/output_stream.hpp"
#include "io/formats/format_table.hpp"
#include "io/json/json_fields.hpp"
#include "io/meshes/stream/reader_program.hpp"
#include "octopair/error.hpp"
#include "octopair/version.hpp"
#include "octree/sweep/sweep.hpp"
#ifdef OCTOPAIR_WITH_PIPELINE
#include "cli/input/shaped_set.hpp"
#endif

namespace octopair::cli {

namespace {

#if defined(__clang__)
constexpr const char* compiler = "clang " __clang_version__;
#else
constexpr const char* compiler = "g++ " __VERSION__;
#endif

#ifdef NDEBUG
constexpr const char* checks = "without assertions";
#else
constexpr const char* checks = "with assertions";
#endif

#ifdef OCTOPAIR_WITH_MESHES
constexpr const char* meshes = ", mesh scenes (Assimp)";
#else
constexpr const char* meshes = "";
#endif

#ifdef OCTOPAIR_WITH_PIPELINE
constexpr const char* json_scenes = ", .json";
#else
constexpr const char* json_scenes = "";
#endif

#ifdef OCTOPAIR_WITH_SERVICE
constexpr const char* servers = ", server (ADDRESS)";
#else
constexpr const char* servers = "";
#endif

std::string line_of(std::string_view name, std::string_view value) { return fmt::format("{:<17}{}\n", name, value); }

std::string format_text(const std::string& path) {
    const io::KnownFormat known = io::known_format(path);
    std::string name = known.format != nullptr ? std::string(known.format->name) : known.ending.substr(1);
#ifdef OCTOPAIR_WITH_MESHES
    const std::string_view program = io::reader_program_of(known.ending);
    if (!program.empty() && io::find_reader_program(program)) return fmt::format("{}, read by {}", name, program);
#endif
    const io::FormatReader reader = known.format != nullptr ? known.format->reader : io::FormatReader::assimp;
    switch (reader) {
        case io::FormatReader::octopair:
            return name;
        case io::FormatReader::checked_assimp:
            return name + ", read by Assimp, checked by octopair";
        case io::FormatReader::assimp:
        case io::FormatReader::program:
        case io::FormatReader::nobody:
            break;
    }
    return name + ", read by Assimp (octopair does not vouch for it)";
}

std::string axes_text(const io::SceneSpace& space) {
    if (space.up == io::UpAxis::unknown) return "not known";
    return space.up == io::UpAxis::y ? "y is up" : "z is up";
}

std::string counted(std::uint64_t count, std::string_view singular, std::string_view plural) {
    return fmt::format("{} {}", grouped(count), count == 1 ? singular : plural);
}

/// Names of shapes, in the order of shape::Any.
constexpr std::array<std::pair<const char*, const char*>, 9> shape_names = {{{"sphere", "spheres"},
                                                                             {"box", "boxes"},
                                                                             {"capsule", "capsules"},
                                                                             {"cylinder", "cylinders"},
                                                                             {"cone", "cones"},
                                                                             {"ellipsoid", "ellipsoids"},
                                                                             {"plane", "planes"},
                                                                             {"convex hull", "convex hulls"},
                                                                             {"mesh", "meshes"}}};

/// Counts of the objects of a scene with shapes.
struct ShapeCounts {
    std::array<std::uint64_t, shape_names.size()> of_kind{};
    std::uint64_t vertices = 0, triangles = 0;
    std::uint64_t without_triangles = 0;  ///< meshes of points and lines alone
};

ShapeCounts count_shapes(const io::LoadedShapes& loaded) {
    ShapeCounts counts;
    for (const std::uint32_t number : loaded.geometry) {
        const shape::Any& shape = loaded.shapes[number];
        ++counts.of_kind[shape.index()];
        const auto* const mesh = std::get_if<shape::Mesh>(&shape);
        if (mesh == nullptr) continue;
        counts.vertices += mesh->vertices.size();
        counts.triangles += mesh->triangles.size();
        counts.without_triangles += mesh->triangles.empty();
    }
    return counts;
}

std::string objects_text(const InputSet& set, const std::optional<ShapeCounts>& counts) {
    if (!counts) {
        const std::string& path = set.parts.front().path;
        const bool spheres = io::is_npy_file(path) && io::NpyScene(path).shape().spheres;
        return spheres ? counted(set.total, "sphere", "spheres") : counted(set.total, "box", "boxes");
    }
    std::string text;
    for (std::size_t kind = 0; kind < shape_names.size(); ++kind) {
        if (counts->of_kind[kind] == 0) continue;
        if (!text.empty()) text += ", ";
        text += counted(counts->of_kind[kind], shape_names[kind].first, shape_names[kind].second);
    }
    return text.empty() ? "none" : text;
}

std::string bounds_text(const InputSet& set) {
    const Box3d bounds = set.bounds();
    if (!std::isfinite(bounds.min[0])) return "none";
    return fmt::format("{:.9g} {:.9g} {:.9g} to {:.9g} {:.9g} {:.9g}", bounds.min[0], bounds.min[1], bounds.min[2],
                       bounds.max[0], bounds.max[1], bounds.max[2]);
}

/// A file, its objects, and counts of its shapes from before their preparation.
struct ReadFile {
    InputSet set;
    std::optional<ShapeCounts> counts;
};

#ifdef OCTOPAIR_WITH_PIPELINE
std::string open_meshes_text(const InputSet& set) {
    constexpr std::size_t named = 3;
    const std::vector<std::uint32_t> open = set.shaped->open_objects();
    std::string text = grouped(open.size());
    for (std::size_t i = 0; i < std::min(open.size(), named); ++i) {
        std::string_view name = set.scene.details.of(open[i], io::Detail::label);
        if (name.empty() && open[i] < set.scene.names.size()) name = set.scene.names[open[i]];
        text += i == 0 ? ": " : ", ";
        text += name.empty() ? fmt::format("object {}", open[i]) : io::shown_text(name);
    }
    return open.size() > named ? text + ", ..." : text;
}
#endif

std::string mesh_lines(const ReadFile& file) {
    std::string text = line_of("vertices", grouped(file.counts->vertices));
    text += line_of("triangles", grouped(file.counts->triangles));
#ifdef OCTOPAIR_WITH_PIPELINE
    if (file.set.shaped != nullptr) text += line_of("open meshes", open_meshes_text(file.set));
#endif
    return text;
}

std::string warning_lines(const ReadFile& file) {
    const std::string& path = file.set.parts.front().path;
    std::vector<std::string> warnings = file.set.scene.warnings;
    if (file.set.total == 0) warnings.push_back(path + ": has no object");
    std::string text;
    for (const std::string& warning : warnings) {
        const bool begins = warning.starts_with(path + ": ");
        text += line_of("warning", begins ? warning.substr(path.size() + 2) : warning);
    }
    return text;
}

std::string not_read_text(const ReadFile& file) {
    std::vector<std::string> parts = file.set.scene.not_read;
    if (file.counts && file.counts->without_triangles > 0)
        parts.push_back(counted(file.counts->without_triangles, "object has", "objects have") +
                        " only points or lines");
    return parts.empty() ? "nothing that octopair knows of" : fmt::format("{}", fmt::join(parts, ", "));
}

std::string describe(const ReadFile& file) {
    const InputSet& set = file.set;
    const std::string& path = set.parts.front().path;
    std::string text = line_of("file", path);
    text += line_of("format", format_text(path));
    const std::string version = io::version_of(path);
    if (!version.empty()) text += line_of("version", version);
    text += line_of("unit", set.scene.space.unit.empty() ? "not known" : set.scene.space.unit);
    text += line_of("axes", axes_text(set.scene.space));
    text += line_of("objects", objects_text(set, file.counts));
    const io::ElementCounts& elements = set.scene.elements;
    if (elements.with_geometry > 0) {
        text += line_of("elements", fmt::format("{} of {} with geometry were read", grouped(elements.read),
                                                grouped(elements.with_geometry)));
    }
    if (set.scene.moving) text += line_of("frames", grouped(set.scene.frames));
    if (file.counts && file.counts->of_kind.back() > 0) text += mesh_lines(file);
    text += line_of("bounds", bounds_text(set));
    text += line_of("not read", not_read_text(file));
    return text + warning_lines(file);
}

/// Returns lines "NAME  VALUE" about each file: format, version, unit, axes, objects by kind, vertices, triangles, open meshes, bounds,
/// what was not read, and warnings. An empty line stands between files.
/// Requires: no other thread of this process runs.
/// Throws: what read_input_set() and make_shaped() throw.
std::string describe_files(const std::vector<std::string>& paths, const std::stop_token& stop) {
    io::SceneContent content;
    content.shapes = true;
    std::vector<ReadFile> files;
    for (const std::string& path : paths) {
        ReadFile file{read_input_set({path}, content, stop), {}};
        if (file.set.scene.shapes) file.counts = count_shapes(*file.set.scene.shapes);
        files.push_back(std::move(file));
    }
    std::string text;
    for (ReadFile& file : files) {
#ifdef OCTOPAIR_WITH_PIPELINE
        make_shaped(file.set, {}, stop);
#endif
        if (const auto invalid = file.set.find_invalid_box()) throw Error(ErrorCode::bad_input, invalid->message);
        if (!text.empty()) text += '\n';
        text += describe(file);
    }
    return text;
}

int run_file_info(const std::vector<std::string>& paths) {
    const Interrupt interrupt;
    const std::string text = describe_files(paths, interrupt.token());
    io::StandardOutput out({});
    out.write(text);
    out.commit();
    return 0;
}

int run_info() {
    io::StandardOutput out({});
    out.write(fmt::format("version          {}\n", OCTOPAIR_VERSION));
    out.write(fmt::format("build            {}, {}\n", compiler, checks));
    out.write(fmt::format("engines          {}{}\n", fmt::join(engine_names(), ", "), servers));
    out.write(fmt::format("stages           {}\n", fmt::join(stage_names(), ", ")));
    out.write(fmt::format("inputs           .npy, .csv{}{}\n", json_scenes, meshes));
    out.write(fmt::format("instruction set  {}\n", sweep_instruction_set()));
    out.write(fmt::format("cores            {}\n", std::thread::hardware_concurrency()));
    out.commit();
    return 0;
}

}  // namespace

void add_info(Command& program, Action& action) {
    Command command = program.add_subcommand("info", "print version, build and engines, or what files hold");
    const auto paths = std::make_shared<std::vector<std::string>>();
    command.begin_section("Input");
    command.add_option("INPUT", *paths, "files: print format, unit, axes, objects, open meshes, what was not read");
    command.set_examples({"octopair info parts.glb"});
    command.callback(
        [&action, paths] { action = [paths] { return paths->empty() ? run_info() : run_file_info(*paths); }; });
}

}  // namespace octopair::cli
