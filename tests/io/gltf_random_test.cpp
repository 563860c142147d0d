// Compares the reader of glTF with random files whose content is known, value for value.
//
// A random scene has meshes of all kinds of primitives, stored in all ways that glTF has, in a tree of nodes with names, transforms and
// copies. Transforms are turns by quarters, scales by powers of two and translations by eighths, so that world coordinates of floats
// and plain integers are exact.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include <fmt/format.h>

#include "io/gltf_builder.hpp"
#include "io/meshes/gltf/gltf_scene.hpp"
#include "support/cases.hpp"

namespace octopair::test {
namespace {

using io::LoadedScene;
using io::MeshObjects;

/// A matrix of 3 rows and 4 columns.
using Matrix = std::array<std::array<double, 4>, 3>;

constexpr Matrix identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

Matrix product(const Matrix& a, const Matrix& b) {
    Matrix result{};
    for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t c = 0; c < 4; ++c) {
            for (std::size_t k = 0; k < 3; ++k) result[r][c] += a[r][k] * b[k][c];
        }
        result[r][3] += a[r][3];
    }
    return result;
}

Point3d moved(const Matrix& m, const Point3d& p) {
    Point3d result;
    for (std::size_t r = 0; r < 3; ++r) result[r] = m[r][0] * p[0] + m[r][1] * p[1] + m[r][2] * p[2] + m[r][3];
    return result;
}

struct ExpectedMesh {
    std::string name;
    std::vector<Triangle3d> triangles;
    std::vector<Point3d> used;  // by all faces
    bool exact = true;
};

struct ExpectedObject {
    std::string name;
    Matrix pose;
    std::size_t mesh;
};

/// The rotations by quarters around one axis: x, y, z, w, and the matrix without scale and translation.
struct QuarterTurn {
    std::array<double, 4> quaternion;
    Matrix matrix;
};
const std::vector<QuarterTurn> turns = {{{0, 0, 0, 1}, identity},
                                        {{0, 0, 1, 1}, {{{0, -1, 0, 0}, {1, 0, 0, 0}, {0, 0, 1, 0}}}},
                                        {{1, 0, 0, 1}, {{{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}}}},
                                        {{0, -1, 0, 1}, {{{0, 0, -1, 0}, {0, 1, 0, 0}, {1, 0, 0, 0}}}},
                                        {{0, 0, 1, 0}, {{{-1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, 1, 0}}}}};

class RandomScene {
public:
    explicit RandomScene(std::uint64_t seed) : random_(seed) {
        const std::size_t mesh_count = pick(1, 3);
        for (std::size_t i = 0; i < mesh_count; ++i) add_mesh();
        const std::size_t roots = pick(1, 3);
        builder_.root["scenes"] = {{{"nodes", json::array()}}};
        builder_.root["nodes"] = json::array();
        builder_.root["scenes"][0]["nodes"] = add_nodes(roots, roots > 1 ? "ROOT/" : "", 0, identity);
    }

    /// Returns the file as text or as GLB.
    std::string file() {
        if (toss()) return builder_.glb();
        return toss() || builder_.data.empty() ? builder_.text() : builder_.text(data_uri());
    }

    std::vector<ExpectedMesh> meshes;
    std::vector<ExpectedObject> objects;

private:
    std::size_t pick(std::size_t least, std::size_t most) {
        return std::uniform_int_distribution<std::size_t>(least, most)(random_);
    }
    bool toss() { return pick(0, 1) == 1; }

    /// Returns a URI with the data, in one of the spellings that URIs and base64 have.
    std::string data_uri() {
        const auto any_of = [&](std::initializer_list<const char*> texts) {
            return std::string(texts.begin()[pick(0, texts.size() - 1)]);
        };
        std::string uri = any_of({"data:", "DATA:", "Data:"}) +
                          any_of({"", "application/gltf-buffer", "application/octet-stream;charset=utf-8", "x-a/b"});
        const auto percent = [&](std::uint8_t c) {
            uri += toss() ? fmt::format("%{:02X}", c) : fmt::format("%{:02x}", c);
        };
        if (pick(0, 3) == 0) {
            uri += ",";
            for (const char c : builder_.data) percent(std::uint8_t(c));
            return uri;
        }
        uri += any_of({";base64,", ";BASE64,", ";base64 ,", "; base64,"});
        std::string text = base64(builder_.data);
        const bool for_urls = toss(), padded = toss(), has_lines = toss(), encoded = toss();
        for (std::size_t i = 0; i < text.size(); ++i) {
            char c = text[i];
            if (c == '=' && !padded) continue;
            if (for_urls && c == '+') c = '-';
            if (for_urls && c == '/') c = '_';
            if (encoded && pick(0, 5) == 0) {
                percent(std::uint8_t(c));
            } else {
                uri += c;
            }
            if (has_lines && i % 76 == 75) uri += any_of({"\n", "\r\n", " ", "%0A"});
        }
        return uri;
    }

    /// Appends the bytes of a number in a type of glTF. Returns the number that a reader should find.
    double append(std::string& bytes, GltfType type, bool normalized) {
        const auto append_as = [&](auto value, double most) {
            bytes += bytes_of(std::vector{value});
            return normalized ? std::max(double(value) / most, -1.0) : double(value);
        };
        const std::uint64_t bits = random_();
        switch (type) {
            case int8:
                return append_as(std::int8_t(bits), 127);
            case uint8:
                return append_as(std::uint8_t(bits), 255);
            case int16:
                return append_as(std::int16_t(bits), 32767);
            case uint16:
                return append_as(std::uint16_t(bits), 65535);
            default:
                return append_as(float(std::int16_t(bits)) / 8, 1);
        }
    }

    static std::size_t bytes_in(GltfType type) { return type <= uint8 ? 1 : (type <= uint16 ? 2 : 4); }

    /// Stores elements of `size` bytes in a view of their own, perhaps with gaps and an offset.
    void store(json& to, const std::string& elements, std::size_t size, bool may_have_gaps) {
        const std::size_t gap = may_have_gaps ? 4 * pick(0, 2) : 0, before = 4 * pick(0, 2);
        std::string bytes(before, '?');
        for (std::size_t i = 0; i < elements.size(); i += size)
            bytes += elements.substr(i, size) + std::string(gap, '?');
        if (toss()) bytes.resize(bytes.size() - gap);  // the last gap may be missing
        const bool stride = gap > 0 || (may_have_gaps && toss());
        to["bufferView"] = builder_.view(bytes + std::string(pick(0, 2), '?'),
                                         stride ? json{{"byteStride", size + gap}} : json::object());
        if (before > 0 || toss()) to["byteOffset"] = before;
    }

    /// Replaces some elements of an accessor. `values` are those that a reader should find.
    void make_sparse(json& accessor, GltfType type, bool normalized, std::vector<Point3d>& values) {
        if (toss()) {
            accessor.erase("bufferView");
            accessor.erase("byteOffset");
            std::fill(values.begin(), values.end(), Point3d{});
        }
        std::vector<std::uint16_t> indices;
        std::string bytes;
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (pick(0, 2) > 0) continue;
            indices.push_back(std::uint16_t(i));
            for (double& at : values[i]) at = append(bytes, type, normalized);
        }
        json& sparse = accessor["sparse"];
        sparse = {{"count", indices.size()}, {"indices", {{"componentType", uint16}}}};
        store(sparse["indices"], bytes_of(indices), 2, false);
        store(sparse["values"], bytes, 3 * bytes_in(type), false);
    }

    std::size_t add_positions(std::vector<Point3d>& values, bool& exact) {
        const auto type = std::array{float32, float32, int8, uint8, int16, uint16}[pick(0, 5)];
        const bool normalized = type != float32 && toss();
        exact &= !normalized;
        std::string bytes;
        for (Point3d& value : values) {
            for (double& at : value) at = append(bytes, type, normalized);
        }
        json accessor = {{"componentType", type}, {"count", values.size()}, {"type", "VEC3"}};
        if (normalized || toss()) accessor["normalized"] = normalized;
        store(accessor, bytes, 3 * bytes_in(type), true);
        if (pick(0, 3) == 0) make_sparse(accessor, type, normalized, values);
        return builder_.add("accessors", accessor);
    }

    std::size_t add_indices(std::vector<std::size_t>& indices, std::size_t vertices) {
        const auto type = std::array{uint8, uint16, uint32}[pick(0, 2)];
        std::string bytes;
        for (std::size_t& index : indices) {
            index = pick(0, vertices - 1);
            bytes += bytes_of<std::uint32_t>({std::uint32_t(index)}).substr(0, bytes_in(type));
        }
        json accessor = {{"componentType", type}, {"count", indices.size()}, {"type", "SCALAR"}};
        store(accessor, bytes, bytes_in(type), false);
        return builder_.add("accessors", accessor);
    }

    void add_mesh() {
        ExpectedMesh expected;
        json mesh = {{"primitives", json::array()}};
        if (toss()) mesh["name"] = expected.name = "mesh " + std::to_string(meshes.size());
        const std::size_t primitives = pick(1, 3);
        for (std::size_t i = 0; i < primitives; ++i) mesh["primitives"].push_back(add_primitive(expected));
        builder_.add("meshes", mesh);
        meshes.push_back(expected);
    }

    json add_primitive(ExpectedMesh& expected) {
        const std::size_t mode = pick(0, 3) > 0 ? 4 : pick(0, 6);
        std::vector<Point3d> values(3 * pick(1, 4));
        json primitive = {{"attributes", {{"POSITION", add_positions(values, expected.exact)}}}};
        std::vector<std::size_t> corners(values.size());
        for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = i;
        if (toss()) {
            corners.resize(6 * pick(1, 3));
            primitive["indices"] = add_indices(corners, values.size());
        }
        if (mode != 4 || toss()) primitive["mode"] = mode;
        if (mode == 1) corners.resize(corners.size() / 2 * 2);
        for (const std::size_t corner : corners) expected.used.push_back(values[corner]);
        const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
            expected.triangles.push_back({values[corners[a]], values[corners[b]], values[corners[c]]});
        };
        for (std::size_t i = 0; mode == 4 && i < corners.size(); i += 3) add(i, i + 1, i + 2);
        for (std::size_t i = 0; mode > 4 && i + 2 < corners.size(); ++i) {
            if (mode == 5) add(i + i % 2, i + 1 - i % 2, i + 2);
            if (mode == 6) add(0, i + 1, i + 2);
        }
        return primitive;
    }

    /// Adds the keys of a random transform to a node. Returns the matrix.
    Matrix add_pose(json& node) {
        Matrix matrix = turns[0].matrix;
        Point3d scale = {1, 1, 1}, place{};
        const auto turn = turns[pick(0, turns.size() - 1)];
        if (toss()) {
            for (double& at : scale) at = std::ldexp(toss() ? 1 : -1, int(pick(0, 4)) - 2);
        }
        if (toss()) {
            for (double& at : place) at = (double(pick(0, 2000)) - 1000) / 8;
        }
        matrix = turn.matrix;
        for (std::size_t r = 0; r < 3; ++r) {
            for (std::size_t c = 0; c < 3; ++c) matrix[r][c] *= scale[c];
            matrix[r][3] = place[r];
        }
        if (toss()) {
            if (toss() || place != Point3d{}) node["translation"] = place;
            if (toss() || turn.matrix != identity) node["rotation"] = turn.quaternion;
            if (toss() || scale != Point3d{1, 1, 1}) node["scale"] = scale;
        } else if (toss() || matrix != identity) {
            for (std::size_t c = 0; c < 4; ++c) {
                for (std::size_t r = 0; r < 4; ++r) node["matrix"].push_back(r == 3 ? double(c == 3) : matrix[r][c]);
            }
        }
        return matrix;
    }

    /// Adds the copies of a node. `path` and `pose` are those of the node.
    void add_copies(json& node, const std::string& path, const Matrix& pose, std::size_t mesh) {
        const std::size_t count = pick(1, 3);
        std::vector<float> places;
        std::vector<std::int16_t> rotations;
        const bool turned = toss(), placed = !turned || toss();
        for (std::size_t i = 0; i < count; ++i) {
            const auto turn = turned ? turns[pick(0, turns.size() - 1)] : turns[0];
            Matrix matrix = turn.matrix;
            for (const double at : turn.quaternion) rotations.push_back(std::int16_t(at * 20000));
            for (std::size_t axis = 0; placed && axis < 3; ++axis) {
                places.push_back(float(pick(0, 100)) / 8);
                matrix[axis][3] = double(places.back());
            }
            objects.push_back({path + "/#" + std::to_string(i), product(pose, matrix), mesh});
        }
        json& attributes = node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
        if (placed) attributes["TRANSLATION"] = builder_.accessor(places, float32, "VEC3");
        if (turned) attributes["ROTATION"] = builder_.accessor(rotations, int16, "VEC4", {{"normalized", true}});
    }

    struct Place {
        std::string path;
        std::size_t depth;
        std::string name;  // empty: it has none
        bool has_mesh;
        std::size_t mesh;
    };

    /// Adds siblings and all below them. Returns their indices. `above`: the path of the parent with a slash, or empty.
    std::vector<std::size_t> add_nodes(std::size_t count, const std::string& above, std::size_t depth,
                                       const Matrix& pose) {
        std::vector<Place> places;
        std::map<std::string, int> names;  // of meshes of nodes without a name
        for (std::size_t i = 0; i < count; ++i) {
            Place place{"", depth, toss() ? "node " + std::to_string(named_++) : "", pick(0, 2) > 0,
                        pick(0, meshes.size() - 1)};
            if (place.name.empty() && place.has_mesh) ++names[meshes[place.mesh].name];
            places.push_back(place);
        }
        std::vector<std::size_t> indices;
        for (std::size_t i = 0; i < count; ++i) {
            const std::string position = "#" + std::to_string(i);
            const std::string of_mesh = places[i].has_mesh ? meshes[places[i].mesh].name : "";
            std::string name = places[i].name.empty() ? of_mesh : places[i].name;
            if (name.empty() || (places[i].name.empty() && names[of_mesh] > 1)) name += position;
            places[i].path = above + name;
            indices.push_back(add_node(places[i], pose));
        }
        return indices;
    }

    /// Adds a node and all below it. Returns its index.
    std::size_t add_node(const Place& place, const Matrix& above) {
        json node = json::object();
        const std::size_t index = builder_.node(json());
        if (!place.name.empty()) node["name"] = place.name;
        if (pick(0, 5) == 0) node["extensions"]["KHR_node_visibility"]["visible"] = toss();
        const Matrix pose = product(above, add_pose(node));
        if (place.has_mesh) {
            node["mesh"] = place.mesh;
            if (pick(0, 3) == 0) {
                add_copies(node, place.path, pose, place.mesh);
            } else {
                objects.push_back({place.path, pose, place.mesh});
            }
        }
        const std::size_t children = place.depth > 2 ? 0 : pick(0, 2);
        if (children > 0) node["children"] = add_nodes(children, place.path + "/", place.depth + 1, pose);
        builder_.root["nodes"][index] = node;
        return index;
    }

    std::mt19937_64 random_;
    GltfBuilder builder_;
    std::size_t named_ = 0;
};

/// Compares numbers: exactly, or up to the rounding of a few operations.
void expect_near(double value, double expected, bool exact) {
    if (exact) {
        EXPECT_EQ(value, expected);
    } else {
        EXPECT_NEAR(value, expected, 1e-12 * (1 + std::abs(expected)));
    }
}

void check_nodes(const RandomScene& expected, const LoadedScene& scene) {
    ASSERT_EQ(scene.objects, expected.objects.size());
    for (std::size_t i = 0; i < expected.objects.size(); ++i) {
        const ExpectedObject& object = expected.objects[i];
        const ExpectedMesh& own = expected.meshes[object.mesh];
        EXPECT_EQ(scene.names[i], object.name);
        EXPECT_EQ(scene.shapes->poses[i].rows, object.pose);
        Box3d box{{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
        for (const Point3d& vertex : own.used) {
            const Point3d at = moved(object.pose, vertex);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                box.min[axis] = std::min(box.min[axis], at[axis]);
                box.max[axis] = std::max(box.max[axis], at[axis]);
            }
        }
        const Box3d& found = std::get<Buffer<Box3d>>(scene.boxes)[i];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            expect_near(found.min[axis], box.min[axis], own.exact);
            expect_near(found.max[axis], box.max[axis], own.exact);
            EXPECT_LE(found.min[axis], box.min[axis]);
            EXPECT_GE(found.max[axis], box.max[axis]);
        }
        const auto& mesh = std::get<shape::Mesh>(scene.shapes->shapes[scene.shapes->geometry[i]]);
        ASSERT_EQ(mesh.triangles.size(), own.triangles.size());
        for (std::size_t t = 0; t < own.triangles.size(); ++t) {
            for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(mesh.vertices[mesh.triangles[t][k]], own.triangles[t][k]);
        }
    }
}

void check_triangles(const RandomScene& expected, const LoadedScene& exact, const LoadedScene& boxes) {
    std::size_t next = 0;
    for (std::size_t i = 0; i < expected.objects.size(); ++i) {
        const ExpectedMesh& own = expected.meshes[expected.objects[i].mesh];
        for (const Triangle3d& triangle : own.triangles) {
            ASSERT_LT(next, exact.objects);
            EXPECT_EQ(exact.triangles->owner_names[exact.triangles->owners[next]], expected.objects[i].name);
            const Triangle3d& found = exact.triangles->triangles[next];
            const Box3f& box = std::get<Buffer<Box3f>>(boxes.boxes)[next];
            for (std::size_t axis = 0; axis < 3; ++axis) {
                float least = INFINITY, most = -INFINITY;
                for (std::size_t k = 0; k < 3; ++k) {
                    expect_near(found[k][axis], moved(expected.objects[i].pose, triangle[k])[axis], own.exact);
                    least = std::min(least, float(found[k][axis]));
                    most = std::max(most, float(found[k][axis]));
                }
                EXPECT_EQ(box.min[axis], least);
                EXPECT_EQ(box.max[axis], most);
            }
            ++next;
        }
    }
    EXPECT_EQ(next, exact.objects);
    EXPECT_EQ(next, boxes.objects);
}

TEST(RandomGltf, IsReadValueForValue) {
    const std::uint64_t count = case_count(1000);
    for (std::uint64_t i = 0; i < count && !::testing::Test::HasFailure(); ++i) {
        const std::uint64_t seed = case_seed("gltf", i);
        SCOPED_TRACE("OCTOPAIR_TEST_SEED=" + std::to_string(seed));
        RandomScene expected(seed);
        const std::string file = expected.file();
        const auto read = [&](MeshObjects objects, bool shapes) {
            auto scene = io::parse_gltf_scene("f.gltf", as_buffer(file), {objects, shapes, {}}, {});
            return scene ? std::move(*scene) : LoadedScene();
        };
        check_nodes(expected, read(MeshObjects::node, true));
        check_triangles(expected, read(MeshObjects::triangle, true), read(MeshObjects::triangle, false));
        if (::testing::Test::HasFailure()) std::printf("%s\n", file.c_str());
    }
}

}  // namespace
}  // namespace octopair::test
