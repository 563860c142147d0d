#include "io/json/json_scene.hpp"

#include <cmath>
#include <filesystem>
#include <map>
#include <unordered_map>
#include <unordered_set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/files/failure.hpp"
#include "io/files/input_file.hpp"
#include "io/formats/format_choice.hpp"
#include "io/json/json_fields.hpp"
#ifdef OCTOPAIR_WITH_MESHES
#include "io/meshes/assimp/mesh_file.hpp"
#include "io/meshes/assimp/scene_parts.hpp"
#include "io/meshes/gltf/gltf_scene.hpp"
#include "io/meshes/plain/plain_mesh.hpp"
#include "io/meshes/stream/reader_program.hpp"
#include "io/meshes/three_mf/three_mf_scene.hpp"
#endif

namespace octopair::io {

namespace {

using nlohmann::json;

/// Returns the pose with the position and the rotation of the two keys. Both keys are optional.
Pose read_pose(const JsonFields& fields, std::string_view place_key, std::string_view turn_key) {
    const Point3d place = fields.find(place_key) != nullptr ? fields.point(place_key) : Point3d{0, 0, 0};
    const json* value = fields.find(turn_key);
    if (value == nullptr) return make_pose(place);
    const json::array_t& array = json_array(*value, fields.place_of(turn_key));
    std::array<double, 4> turn;
    if (array.size() != 4) {
        fields.refuse_key(turn_key, fmt::format("an array of {}, not a quaternion w, x, y, z", array.size()));
    }
    for (std::size_t i = 0; i < 4; ++i) {
        if (!array[i].is_number()) fields.refuse_key(turn_key, "not a quaternion w, x, y, z");
        turn[i] = array[i].get<double>();
    }
    const double length = std::hypot(std::hypot(turn[0], turn[1]), std::hypot(turn[2], turn[3]));
    if (!(length > 0)) fields.refuse_key(turn_key, "the quaternion has length 0");
    if (!std::isfinite(length))
        fields.refuse_key(turn_key, "the length of the quaternion is outside the range of float64");
    return make_pose(place, turn);
}

class SceneParser {
public:
    SceneParser(std::string_view file, const MeshLoader& load_mesh, const std::stop_token& stop)
        : file_(file), load_mesh_(load_mesh), stop_(stop) {}

    LoadedScene parse(const json& root) {
        const JsonFields fields(root, std::string(file_));
        fields.allow({"objects", "shapes"});
        if (const json* shapes = fields.find("shapes")) add_shapes(*shapes);
        const json::array_t& objects = json_array(fields.required("objects"), fields.place_of("objects"));
        loaded_.geometry.reserve(objects.size());
        loaded_.poses.reserve(objects.size());
        for (std::size_t i = 0; i < objects.size(); ++i) {
            if (stop_.stop_requested()) cancel();
            add_object(objects[i], i);
        }
        LoadedScene scene;
        scene.objects = objects.size();
        scene.names = std::move(names_);
        if (!parents_.empty()) scene.details = std::move(details_);
        scene.shapes = std::move(loaded_);
        return scene;
    }

private:
    void add_shapes(const json& shapes) {
        const JsonFields fields(shapes, fmt::format("{}: shapes", file_));
        for (const auto& [name, value] : shapes.items()) {
            if (stop_.stop_requested()) cancel();
            shape_numbers_.emplace(name, loaded_.shapes.size());
            const std::string place = fmt::format("{}: shape '{}'", file_, shown_text(name));
            loaded_.shapes.push_back(json_shape(value, place, load_mesh_, stop_));
        }
    }

    void add_object(const json& value, std::size_t number) {
        std::string place = fmt::format("{}: object {}", file_, number);
        const JsonFields nameless(value, place);
        names_.push_back(nameless.find("name") != nullptr ? nameless.text("name") : std::string());
        if (!names_.back().empty()) place += fmt::format(" ('{}')", shown_text(names_.back()));
        const JsonFields fields(value, place);
        fields.allow({"name", "shape", "position", "rotation", "end_position", "end_rotation", "group", "mask",
                      "padding", "parent"});
        loaded_.geometry.push_back(shape_number(fields));
        loaded_.poses.push_back(read_pose(fields, "position", "rotation"));
        add_parent(fields);
        add_end(fields, number);
        if (fields.find("padding") != nullptr) set(loaded_.padding, number, fields.at_least_zero("padding"), 0.0);
        if (fields.find("group") != nullptr) {
            set(loaded_.groups, number, fields.whole_number("group"), LoadedShapes::default_groups);
        }
        if (fields.find("mask") != nullptr) {
            set(loaded_.masks, number, fields.whole_number("mask"), LoadedShapes::default_mask);
        }
        fill_defaults(number + 1);
    }

    std::uint32_t shape_number(const JsonFields& fields) {
        const json& shape = fields.required("shape");
        if (!shape.is_string()) {
            loaded_.shapes.push_back(json_shape(shape, fields.place_of("shape"), load_mesh_, stop_));
            return std::uint32_t(loaded_.shapes.size() - 1);
        }
        const std::string& name = fields.text("shape");
        const auto found = shape_numbers_.find(name);
        if (found == shape_numbers_.end()) {
            fields.refuse_key(
                "shape", fmt::format("no shape has the name '{}'; add it to 'shapes' at the root", shown_text(name)));
        }
        return found->second;
    }

    void add_parent(const JsonFields& fields) {
        DetailTexts texts;
        if (fields.find("parent") != nullptr) texts[std::size_t(Detail::parent)] = fields.text("parent");
        details_builder_.add(texts);
        const auto next = std::uint32_t(last_parent_);
        if (fields.find("parent") == nullptr) {
            loaded_.parents.push_back(next);
            ++last_parent_;
            return;
        }
        const auto [parent, is_new] = parents_.try_emplace(fields.text("parent"), next);
        last_parent_ += is_new;
        loaded_.parents.push_back(parent->second);
    }

    /// Adds the end pose of an object. A missing end position or end rotation equals that at the start.
    void add_end(const JsonFields& fields, std::size_t number) {
        const bool moves = fields.find("end_position") != nullptr, turns = fields.find("end_rotation") != nullptr;
        if (!moves && !turns) return;
        if (loaded_.end_poses.empty()) loaded_.end_poses.assign(loaded_.poses.begin(), loaded_.poses.end() - 1);
        loaded_.end_poses.resize(number);
        loaded_.end_poses.push_back(
            read_pose(fields, moves ? "end_position" : "position", turns ? "end_rotation" : "rotation"));
    }

    template <typename T>
    static void set(std::vector<T>& values, std::size_t number, T value, T absent) {
        values.resize(number, absent);
        values.push_back(value);
    }

    /// Fills each optional array that is in use with defaults, up to `objects` elements.
    void fill_defaults(std::size_t objects) {
        if (!loaded_.padding.empty()) loaded_.padding.resize(objects, 0.0);
        if (!loaded_.groups.empty()) loaded_.groups.resize(objects, LoadedShapes::default_groups);
        if (!loaded_.masks.empty()) loaded_.masks.resize(objects, LoadedShapes::default_mask);
        if (!loaded_.end_poses.empty()) loaded_.end_poses.resize(objects, loaded_.poses.back());
    }

    std::string_view file_;
    const MeshLoader& load_mesh_;
    const std::stop_token& stop_;
    LoadedShapes loaded_;
    std::vector<std::string> names_;
    ObjectDetails details_;  // only the parents of the objects
    DetailsBuilder details_builder_{details_};
    std::map<std::string, std::uint32_t, std::less<>> shape_numbers_;
    std::unordered_map<std::string, std::uint32_t> parents_;
    std::uint64_t last_parent_ = 0;
};

/// Reads a mesh file. Adds the file's LoadedScene::largest_rounded and warnings to `scene`.
shape::Mesh load_mesh(const std::string& path, [[maybe_unused]] LoadedScene& scene,
                      [[maybe_unused]] const std::stop_token& stop) {
#ifdef OCTOPAIR_WITH_MESHES
    check_readable(path);
    if (std::string warning = name_warning(path); !warning.empty()) scene.warnings.push_back(std::move(warning));
    const std::string ending = format_ending(path);
    if (ending == ".opmodel" || reader_program_of(ending) == "octopair-step")
        refuse(path, "a JSON scene cannot name it; give it as an input of its own");
    if (is_plain_ending(ending)) return read_plain_mesh(path, scene, stop);
    if (is_gltf_ending(ending)) {
        if (auto mesh = read_gltf_mesh(path, scene, stop)) return std::move(*mesh);
    }
    if (is_three_mf_ending(ending)) return read_three_mf_mesh(path, scene, stop);
    const MeshFile file(path, true);
    scene.largest_rounded = std::max(scene.largest_rounded, file.largest_rounded());
    for (std::string& warning : import_warnings(file)) scene.warnings.push_back(std::move(warning));
    file.crossing_faces().append_warning(path, scene.warnings);
    return whole_mesh_of(file);
#else
    refuse(path, "this build of octopair reads no mesh files");
#endif
}

/// Returns the texts in order, without repetitions. Several objects may name one file, which is read only once.
std::vector<std::string> distinct(std::vector<std::string> texts) {
    std::unordered_set<std::string> seen;
    std::erase_if(texts, [&](const std::string& text) { return !seen.insert(text).second; });
    return texts;
}

}  // namespace

LoadedScene parse_json_scene(std::string_view text, std::string_view file, const MeshLoader& load_mesh,
                             const std::stop_token& stop) {
    const json root = parse_json(text, file, stop);
    return SceneParser(file, load_mesh, stop).parse(root);
}

LoadedScene read_json_scene(const std::string& path, const std::stop_token& stop) {
    const InputFile file(path);
    Buffer<char> text{std::size_t(file.size())};
    file.read(0, std::as_writable_bytes(text.span()), stop);
    const std::filesystem::path directory = std::filesystem::path(path).parent_path();
    LoadedScene meshes;  // collects warnings and bounds of the mesh files that the scene names
    const auto load = [&](const std::string& name) { return load_mesh((directory / name).string(), meshes, stop); };
    if (text.size() == 0) refuse(path, "is empty");  // the file had content when its format was decided
    LoadedScene scene = parse_json_scene({text.data(), text.size()}, path, load, stop);
    scene.largest_rounded = meshes.largest_rounded;
    scene.warnings = distinct(std::move(meshes.warnings));
    return scene;
}

}  // namespace octopair::io
