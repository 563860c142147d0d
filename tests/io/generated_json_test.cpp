// Tests the reader of JSON scenes with random files, in all spellings of the format, whose content is known.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "io/json/json_scene.hpp"
#include "io/spelling.hpp"

namespace octopair::test {
namespace {

using io::LoadedShapes;

std::string text_of(double value) { return fmt::format("{:a} ", value + 0.0); }  // -0 is 0: JSON's "-0" is an integer
std::string text_of(const Point3d& point) { return text_of(point[0]) + text_of(point[1]) + text_of(point[2]); }
std::string text_of(const shape::Sphere& sphere) { return text_of(sphere.radius); }
std::string text_of(const shape::Box& box) { return text_of(box.half_extents); }
std::string text_of(const shape::Ellipsoid& ellipsoid) { return text_of(ellipsoid.radii); }
std::string text_of(const shape::Plane& plane) { return text_of(plane.normal) + text_of(plane.offset); }
template <typename Round>
std::string text_of(const Round& round) {
    return text_of(round.radius) + text_of(round.length);
}
std::string text_of(const shape::ConvexHull& hull) {
    std::string text;
    for (const Point3d& point : hull.points) text += text_of(point);
    return text;
}
std::string text_of(const shape::Mesh& mesh) {
    std::string text;
    for (const Point3d& vertex : mesh.vertices) text += text_of(vertex);
    for (const auto& [a, b, c] : mesh.triangles) text += fmt::format("{} {} {} ", a, b, c);
    return text;
}
/// Returns all values of a shape as text.
std::string values_of(const shape::Any& any) {
    return fmt::format("{}: ", any.index()) + std::visit([](const auto& shape) { return text_of(shape); }, any);
}
std::string values_of(const Pose& pose) {
    std::string text;
    for (const auto& row : pose.rows) {
        for (const double at : row) text += text_of(at);
    }
    return text;
}

/// What a file says about an object.
struct JsonObject {
    std::string name, shape;  ///< the shape as values_of() gives it
    Pose pose, end_pose;
    double padding = 0;
    std::uint32_t group = LoadedShapes::default_groups, mask = LoadedShapes::default_mask;
    std::optional<std::string> parent;
};

/// A random JSON scene: its text, and what it says.
class JsonFile {
public:
    explicit JsonFile(std::uint64_t seed) : spelling_(seed) {
        for (std::uint64_t shapes = spelling_.below(4); shapes > 0; --shapes) add_named_shape();
        std::vector<std::string> objects;
        for (std::uint64_t i = spelling_.below(6); i > 0; --i) objects.push_back(object());
        Keys keys = {{"objects", array(objects)}};
        if (!named_.empty() || spelling_.one_in(2)) keys.emplace_back("shapes", "{" + named_text_ + blank() + "}");
        text_ = spelling_.byte_order_mark() + blank() + map(keys) + blank();
    }

    const std::string& text() const { return text_; }
    Spelling& spelling() { return spelling_; }
    const std::vector<JsonObject>& objects() const { return objects_; }

    /// Returns the mesh of a file that the scene names.
    shape::Mesh mesh_file(const std::string& name) const {
        const auto found = mesh_files_.find(name);
        if (found == mesh_files_.end()) throw Error(ErrorCode::bad_input, "m.json: no such file");
        return found->second;
    }

private:
    using Keys = std::vector<std::pair<std::string, std::string>>;

    std::string blank() {
        std::string text;
        while (spelling_.one_in(5)) text += spelling_.one_in(2) ? spelling_.blank() : spelling_.line_end();
        return text;
    }
    /// Returns a string of JSON, in which some characters are escaped.
    std::string quoted(const std::string& text) {
        std::string json = "\"";
        for (const char c : text) {
            const bool may_escape = (c & 0x80) == 0 && spelling_.one_in(6);
            if (c == '"' || c == '\\') {
                json += std::string("\\") + c;
            } else if (c == '/' && may_escape) {
                json += "\\/";
            } else if (may_escape) {
                json += fmt::format("\\u{:04x}", unsigned(c));
            } else {
                json += c;
            }
        }
        return json + "\"";
    }
    std::string array(const std::vector<std::string>& values) {
        std::string text = "[";
        for (const std::string& value : values) text += (&value == &values[0] ? "" : ",") + blank() + value + blank();
        return text + "]";
    }
    /// Returns an object of JSON with the keys in any order.
    std::string map(Keys keys) {
        spelling_.shuffle(keys);
        std::string text = "{";
        for (const auto& [key, value] : keys) {
            text += (text.size() == 1 ? "" : ",") + blank() + quoted(key) + blank() + ":" + blank() + value + blank();
        }
        return text + "}";
    }

    /// Returns a number of JSON, which is stricter than other texts. Its value is stored in `value`.
    std::string number(double least_size, double& value) {
        double wanted = spelling_.number();
        if (least_size > 0) wanted = std::max(std::fabs(wanted), least_size);
        wanted = std::clamp(wanted, -1e100, 1e100);
        std::string text = spelling_.one_in(2) ? fmt::format("{}", wanted)
                           : std::fabs(wanted) < 1e6 && spelling_.one_in(2)
                               ? fmt::format("{:.{}f}", wanted, 1 + spelling_.below(8))
                               : fmt::format("{:.{}e}", wanted, spelling_.below(18));
        if (spelling_.one_in(4)) std::replace(text.begin(), text.end(), 'e', 'E');
        if (text.find_first_of(".eE") == std::string::npos && spelling_.one_in(4))
            text += spelling_.pick({".0", "e0", "E+00"});
        value = std::strtod(text.c_str(), nullptr);
        if (least_size == 0 || value > 0) return text;
        value = 1;
        return "1";
    }
    /// Returns a number >= 0, or > 0 if `positive`.
    std::string length(bool positive, double& value) {
        if (positive || spelling_.one_in(2)) return number(1e-3, value);
        value = 0;
        return spelling_.pick({"0", "0.0", "0e9"});
    }
    std::string point(Point3d& value, bool positive = false) {
        std::vector<std::string> texts;
        for (double& at : value) texts.push_back(number(positive ? 1e-3 : 0, at));
        return array(texts);
    }
    std::string points(std::uint64_t count, std::vector<Point3d>& values) {
        std::vector<std::string> texts;
        for (; count > 0; --count) texts.push_back(point(values.emplace_back()));
        return array(texts);
    }

    template <typename Round>
    shape::Any round(Keys& keys, bool may_have_no_length) {
        Round round{};
        keys.emplace_back("radius", length(true, round.radius));
        keys.emplace_back("length", length(!may_have_no_length, round.length));
        return round;
    }
    shape::Any mesh(Keys& keys) {
        shape::Mesh mesh;
        Keys own;
        own.emplace_back("vertices", points(1 + spelling_.below(4), mesh.vertices));
        std::vector<std::string> triangles;
        for (std::uint64_t i = spelling_.below(4); i > 0; --i) {
            std::vector<std::string> corners;
            for (std::uint32_t& corner : mesh.triangles.emplace_back()) {
                corner = std::uint32_t(spelling_.below(mesh.vertices.size()));
                corners.push_back(std::to_string(corner));
            }
            triangles.push_back(array(corners));
        }
        own.emplace_back("triangles", array(triangles));
        if (spelling_.one_in(3)) {
            const std::string name = fmt::format("parts/{}.obj", mesh_files_.size());
            mesh_files_.emplace(name, mesh);
            own = {{"file", quoted(name)}};
        }
        keys.insert(keys.end(), own.begin(), own.end());
        return mesh;
    }

    /// Returns a random shape, and sets its type and its keys.
    shape::Any any_shape(std::string& type, Keys& keys) {
        type = spelling_.pick(
            {"sphere", "box", "capsule", "cylinder", "cone", "ellipsoid", "plane", "convex_hull", "mesh"});
        if (type == "capsule") return round<shape::Capsule>(keys, true);
        if (type == "cylinder") return round<shape::Cylinder>(keys, false);
        if (type == "cone") return round<shape::Cone>(keys, false);
        if (type == "mesh") return mesh(keys);
        if (type == "sphere") {
            shape::Sphere sphere{};
            keys.emplace_back("radius", length(true, sphere.radius));
            return sphere;
        }
        if (type == "box") {
            shape::Box box{};
            keys.emplace_back("half_extents", point(box.half_extents, true));
            return box;
        }
        if (type == "ellipsoid") {
            shape::Ellipsoid ellipsoid{};
            keys.emplace_back("radii", point(ellipsoid.radii, true));
            return ellipsoid;
        }
        if (type == "plane") {
            shape::Plane plane{};
            keys.emplace_back("normal", point(plane.normal, true));
            keys.emplace_back("offset", number(0, plane.offset));
            return plane;
        }
        shape::ConvexHull hull;
        keys.emplace_back("points", points(1 + spelling_.below(4), hull.points));
        return hull;
    }
    std::string shape_text(std::string& values) {
        std::string type;
        Keys keys;
        values = values_of(any_shape(type, keys));
        keys.emplace_back("type", quoted(type));
        return map(keys);
    }
    void add_named_shape() {
        const std::string name = any_name();
        if (named_.contains(name)) return;
        std::string values;
        const std::string text = shape_text(values);
        named_text_ += (named_.empty() ? "" : ",") + blank() + quoted(name) + blank() + ":" + blank() + text;
        named_.emplace(name, values);
    }
    std::string any_name() {
        return spelling_.pick({"wheel", "a b", "K\xc3\xb6rper", "", "x/y", "\"", "\\u0041", "#1"});
    }

    std::string object() {
        JsonObject& object = objects_.emplace_back();
        Keys keys;
        if (!named_.empty() && spelling_.one_in(2)) {
            const auto found = std::next(named_.begin(), std::ptrdiff_t(spelling_.below(named_.size())));
            keys.emplace_back("shape", quoted(found->first));
            object.shape = found->second;
        } else {
            keys.emplace_back("shape", shape_text(object.shape));
        }
        if (spelling_.one_in(2)) keys.emplace_back("name", quoted(object.name = any_name()));
        if (spelling_.one_in(3)) keys.emplace_back("parent", quoted(*(object.parent = any_name())));
        if (spelling_.one_in(3)) keys.emplace_back("padding", length(false, object.padding));
        if (spelling_.one_in(3)) keys.emplace_back("group", bits(object.group));
        if (spelling_.one_in(3)) keys.emplace_back("mask", bits(object.mask));
        add_poses(keys, object);
        return map(keys);
    }
    std::string bits(std::uint32_t& value) {
        value = std::uint32_t(spelling_.one_in(4) ? 0xFFFFFFFF : spelling_.below(1 << 20));
        return std::to_string(value);
    }

    void add_poses(Keys& keys, JsonObject& object) {
        Point3d place = {};
        std::array<double, 4> turn = {1, 0, 0, 0};
        const auto add = [&](const std::string& before) {
            if (spelling_.one_in(2)) keys.emplace_back(before + "position", point(place));
            if (!spelling_.one_in(2)) return;
            std::vector<std::string> texts;
            for (double& at : turn) texts.push_back(number(spelling_.one_in(2) ? 1e-3 : 0, at));
            if (turn == std::array<double, 4>{}) texts[0] = number(1e-3, turn[0]);
            keys.emplace_back(before + "rotation", array(texts));
        };
        add("");
        object.pose = make_pose(place, turn);
        if (spelling_.one_in(3)) add("end_");
        object.end_pose = make_pose(place, turn);
    }

    Spelling spelling_;
    std::string text_, named_text_;
    std::map<std::string, std::string> named_;  // values of each shape
    std::map<std::string, shape::Mesh> mesh_files_;
    std::vector<JsonObject> objects_;
};

/// Returns element i of an optional array.
template <typename T>
T at_or(const std::vector<T>& values, std::size_t i, T absent) {
    return values.empty() ? absent : values.at(i);
}

/// Returns what distinguishes an object of a scene from what the file says; empty if nothing does.
std::string difference_of(const io::LoadedScene& scene, std::size_t i, const JsonObject& expected) {
    const LoadedShapes& shapes = *scene.shapes;
    if (scene.names[i] != expected.name) return "name";
    if (values_of(shapes.shapes.at(shapes.geometry[i])) != expected.shape) return "shape";
    if (values_of(shapes.poses[i]) != values_of(expected.pose)) return "pose";
    const Pose end = shapes.end_poses.empty() ? shapes.poses[i] : shapes.end_poses.at(i);
    if (values_of(end) != values_of(expected.end_pose)) return "end pose";
    if (at_or(shapes.padding, i, 0.0) != expected.padding) return "padding";
    if (at_or(shapes.groups, i, LoadedShapes::default_groups) != expected.group) return "group";
    if (at_or(shapes.masks, i, LoadedShapes::default_mask) != expected.mask) return "mask";
    return scene.details.of(i, io::Detail::parent) == expected.parent.value_or("") ? "" : "parent";
}

std::string difference_of(const io::LoadedScene& scene, const std::vector<JsonObject>& expected) {
    if (scene.objects != expected.size()) return fmt::format("{} objects", scene.objects);
    for (std::size_t i = 0; i < expected.size(); ++i) {
        const std::string what = difference_of(scene, i, expected[i]);
        if (!what.empty()) return fmt::format("object {}: {}", i, what);
        for (std::size_t k = 0; k < i; ++k) {
            const bool same = expected[i].parent && expected[i].parent == expected[k].parent;
            if (same != (scene.shapes->parents[i] == scene.shapes->parents[k]))
                return fmt::format("parents of objects {} and {}", k, i);
        }
    }
    return "";
}

TEST(GeneratedFiles, OfJsonScenesAreReadAsTheyAreWritten) {
    for (std::uint64_t i = 0; i < generated_files() / 4; ++i) {  // they are longer than other files
        const std::uint64_t seed = case_seed("json", i);
        JsonFile file(seed);
        const auto load = [&](const std::string& name) { return file.mesh_file(name); };
        ASSERT_EQ(difference_of(io::parse_json_scene(file.text(), "m.json", load), file.objects()), "")
            << repetition(seed, file.text());

        const std::string mutated = file.spelling().mutated(file.text());
        const std::string fault = fault_of_reading("m.json: ", [&]() -> std::string {
            (void)io::parse_json_scene(mutated, "m.json", load);
            return "";
        });
        ASSERT_EQ(fault, "") << repetition(seed, mutated);
    }
}

}  // namespace
}  // namespace octopair::test
