// parse_obj(): the object files of Wavefront. Each object and each group is a mesh. Points and lines are faces with fewer than three
// corners. Everything else but places, names and materials is ignored.
#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <map>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/plain/text_lines.hpp"

namespace octopair::io {

namespace {

/// Returns the text with joined lines: a backslash at the end of a line joins the next.
std::string with_joined_lines(std::string_view text) {
    std::string joined(text);
    for (std::size_t at = joined.find('\\'); at != std::string::npos; at = joined.find('\\', at + 1)) {
        std::size_t end = at + 1;
        if (end < joined.size() && joined[end] == '\r') ++end;
        if (end < joined.size() && joined[end] == '\n')
            std::fill(joined.begin() + std::ptrdiff_t(at), joined.begin() + std::ptrdiff_t(end) + 1, ' ');
    }
    return joined;
}

class ObjParser {
public:
    explicit ObjParser(const FileContent& file) : file_(file), lines_(file, '#') {}

    std::vector<PlainMesh> parse() {
        begin_mesh({});
        while (lines_.next()) {
            const std::string_view word = lines_.word();
            if (word == "v") {
                if (vertices_.size() == 0xFFFFFFFF) lines_.refuse_line("a file has more than 2^32 - 1 vertices");
                Point3d& place = vertices_.emplace_back();
                for (double& at : place) at = lines_.number("a coordinate");
            } else if (word == "f" || word == "l" || word == "p") {
                read_face();
            } else if (word == "usemtl") {
                material_ = lines_.rest();
                material_is_new_ = true;
            } else if (word == "o") {
                begin_object(std::string(lines_.rest()));
            } else if (word == "g" && lines_.rest() != group_) {
                group_ = lines_.rest();
                begin_mesh(group_);
            }
        }
        std::erase_if(meshes_, [](const PlainMesh& mesh) { return mesh.ends.empty(); });
        if (meshes_.empty()) {  // points only
            meshes_.emplace_back().vertices = std::move(vertices_);
            return std::move(meshes_);
        }
        give_vertices();
        return std::move(meshes_);
    }

private:
    void begin_mesh(std::string name) {
        current_ = meshes_.size();
        material_is_new_ = true;
        meshes_.emplace_back().name = std::move(name);
    }

    /// Objects of one name are one mesh.
    void begin_object(const std::string& name) {
        const auto [known, fresh] = objects_.try_emplace(name, meshes_.size());
        if (fresh) return begin_mesh(name);
        current_ = known->second;
        material_is_new_ = true;
    }

    void read_face() {
        PlainMesh& mesh = meshes_[current_];
        if (std::exchange(material_is_new_, false) && !material_.empty()) mesh.materials.insert(material_);
        for (std::string_view word = lines_.word(); !word.empty(); word = lines_.word())
            mesh.corners.push_back(corner_of(word));
        mesh.end_face();
    }

    /// Returns the vertex of a corner "7", "7/1", "7//3" or "7/1/3". Negative numbers count back from the last vertex.
    std::uint32_t corner_of(std::string_view word) const {
        std::int64_t number = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
        const bool whole = error == std::errc() && (end == word.data() + word.size() || *end == '/');
        if (!whole || number == 0) lines_.refuse_line("a corner of a face is not the number of a vertex");
        const auto count = std::int64_t(vertices_.size());
        if (number > 0xFFFFFFFF || -number > count) {
            lines_.refuse_line(
                fmt::format("a corner of a face is vertex {}, but there are {} before it", number, count));
        }
        return std::uint32_t(number > 0 ? number - 1 : count + number);
    }

    /// Gives each mesh the vertices that it uses, in the order of their use.
    void give_vertices() {
        constexpr std::uint32_t unused = ~std::uint32_t(0);
        std::vector<std::uint32_t> numbers(vertices_.size(), unused);
        for (PlainMesh& mesh : meshes_) {
            std::vector<std::uint32_t> used;
            for (std::uint32_t& corner : mesh.corners) {
                if (corner >= vertices_.size()) {
                    refuse(file_.path, fmt::format("a face has vertex {}, but there are {}", std::uint64_t(corner) + 1,
                                                   vertices_.size()));
                }
                if (numbers[corner] == unused) {
                    numbers[corner] = std::uint32_t(used.size());
                    used.push_back(corner);
                    mesh.vertices.push_back(vertices_[corner]);
                }
                corner = numbers[corner];
            }
            for (const std::uint32_t vertex : used) numbers[vertex] = unused;
        }
    }

    const FileContent& file_;
    TextLines lines_;
    std::vector<Point3d> vertices_;
    std::vector<PlainMesh> meshes_;
    std::size_t current_ = 0;  // mesh that faces are added to
    std::string group_, material_;
    bool material_is_new_ = false;                // true if the current mesh may lack the material
    std::map<std::string, std::size_t> objects_;  // meshes of objects, by name
};

}  // namespace

std::vector<PlainMesh> parse_obj(const FileContent& file) {
    if (file.bytes.find('\\') == std::string_view::npos) return ObjParser(file).parse();
    const std::string joined = with_joined_lines(file.bytes);
    const FileContent without_breaks{joined, file.path, file.stop, file.progress};
    return ObjParser(without_breaks).parse();
}

}  // namespace octopair::io
