// parse_obj(): the object files of Wavefront. Each object and each group of an object is a mesh. Points and lines are faces with fewer
// than three corners. Everything else but places, names and materials is left out.
//
// - An object begins with `o`, a group with `g`. All faces of one object and one group are one mesh, wherever they are in the file.
// - A new object ends the group. The faces of a group belong to the object's own mesh if the group has no name, or the object's name. A
//   group before all objects is like an object.
// - A comment is a line that begins with `#`, or the end of a line with places or corners. In names, `#` is a character.
// - Keywords are small letters. If no line begins with `v`, they may be capitals.
#include <algorithm>
#include <charconv>
#include <iterator>
#include <map>
#include <string>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/plain/text_lines.hpp"

namespace octopair::io {

namespace {

/// Meaning of a line of an OBJ file.
enum class ObjKeyword : std::uint8_t {
    vertex,
    face,
    line,    ///< a polyline
    points,  ///< any number of points
    material,
    object,
    group,
    ignored,   ///< says nothing about geometry
    freeform,  ///< curves and surfaces, which are not read
    call,      ///< another file, which is not read
    unknown,
};

/// Returns the meaning of the first word of a line, after Wavefront's specification with the superseded keywords. Requires: letters are
/// small.
ObjKeyword obj_keyword(std::string_view word) {
    using enum ObjKeyword;
    static constexpr std::pair<std::string_view, ObjKeyword> others[] = {
        {"g", group}, {"o", object}, {"usemtl", material}, {"l", line}, {"p", points}, {"fo", face}, {"call", call}};
    static constexpr std::string_view ignored_words[] = {
        "vn",    "vt",       "s",        "mtllib", "vp",    "mg",         "usemap", "maplib",   "lod",
        "bevel", "c_interp", "d_interp", "ctech",  "stech", "shadow_obj", "csh",    "trace_obj"};
    static constexpr std::string_view freeform_words[] = {"cstype", "deg",  "bmat", "step", "curv", "curv2", "surf",
                                                          "parm",   "trim", "hole", "scrv", "sp",   "end",   "con",
                                                          "bsp",    "bzp",  "cdc",  "cdp",  "res"};
    const auto is_in = [&](const auto& words) {
        return std::find(std::begin(words), std::end(words), word) != std::end(words);
    };
    // The most frequent keywords come first, for speed.
    if (word == "v") return vertex;
    if (word == "f") return face;
    if (is_in(ignored_words)) return ignored;
    const auto* const other =
        std::find_if(std::begin(others), std::end(others), [&](const auto& entry) { return entry.first == word; });
    if (other != std::end(others)) return other->second;
    return is_in(freeform_words) ? freeform : unknown;
}

/// Returns whether a line begins with `v`. In most files it is one of the first lines.
bool has_small_vertex(std::string_view text) {
    for (LineSplitter lines(text); lines.next();) {
        const std::string_view line = lines.line();
        const std::size_t begin = std::min(line.find_first_not_of(" \t"), line.size());
        if (line.substr(begin).starts_with("v ") || line.substr(begin).starts_with("v\t")) return true;
    }
    return false;
}

/// Counts lines of one kind that are not read.
struct UnreadLines {
    std::uint64_t count = 0, first = 0;
    std::string first_word;

    void add(std::uint64_t line, std::string_view word) {
        if (count++ > 0) return;
        first = line;
        first_word = shown(word);
    }
    void warn(const FileContent& file, std::string_view what) const {
        if (count == 0) return;
        file.warn(fmt::format("{}: {} {} not read, the first is line {} ('{}')", what, count,
                              count == 1 ? "line is" : "lines are", first, first_word));
    }
};

/// A mesh, and the name of the object that it is a group of.
struct ObjPart {
    PlainMesh mesh;
    std::string object;
};

/// If several groups have the same name, puts the name of the object in front of each group's name.
void name_equal_groups(std::vector<ObjPart>& parts, const FileContent& file) {
    std::unordered_map<std::string, std::size_t> uses;
    std::size_t steps = 0;
    const auto check = [&] {
        if (++steps % 4096 == 0) file.checkpoint(file.bytes.size());
    };
    for (const ObjPart& part : parts) {
        check();
        ++uses[part.mesh.name];
    }
    for (ObjPart& part : parts) {
        check();
        if (uses[part.mesh.name] > 1 && part.mesh.name != part.object)
            part.mesh.name = part.object + '/' + part.mesh.name;
    }
}

class ObjParser {
public:
    explicit ObjParser(const FileContent& file) : file_(file), lines_(file), capitals_(!has_small_vertex(file.bytes)) {}

    std::vector<PlainMesh> parse() {
        begin_part();
        bool is_empty = true;
        while (lines_.next()) {
            is_empty = false;
            if (lines_.begins_with('#')) continue;
            if (!lines_.contains('#')) lines_.join_continued('\\');  // a comment cannot be continued
            read_line();
        }
        if (is_empty) refuse(file_.path, "is empty");
        if (vertices_.empty() && unknown_.count > 0) {
            refuse(file_.path,
                   fmt::format("line {}: '{}' is no keyword of OBJ, and the file has no vertices; if it is of "
                               "another format, give it the ending of that format",
                               unknown_.first, unknown_.first_word));
        }
        unknown_.warn(file_, "has keywords that OBJ does not have");
        freeform_.warn(file_, "has free-form curves or surfaces; save them as polygons");
        calls_.warn(file_, "calls other files");
        return finish();
    }

private:
    void read_line() {
        const std::string_view word = lines_.word();
        if (word.empty()) return;  // the line has only the mark of a continued line
        switch (keyword_of(word)) {
            case ObjKeyword::vertex:
                return read_vertex();
            case ObjKeyword::face:
                return read_face();
            case ObjKeyword::line:
                return read_pieces(2);
            case ObjKeyword::points:
                return read_pieces(1);
            case ObjKeyword::material:
                material_ = lines_.rest();
                material_is_new_ = true;
                return;
            case ObjKeyword::object:
                object_ = lines_.rest();
                group_.clear();
                return begin_part();
            case ObjKeyword::group:
                group_ = lines_.rest();
                return begin_part();
            case ObjKeyword::ignored:
                return;
            case ObjKeyword::freeform:
                return freeform_.add(lines_.line_number(), word);
            case ObjKeyword::call:
                return calls_.add(lines_.line_number(), word);
            case ObjKeyword::unknown:
                return unknown_.add(lines_.line_number(), word);
        }
    }

    ObjKeyword keyword_of(std::string_view word) const {
        return capitals_ ? obj_keyword(in_lower_case(word)) : obj_keyword(word);
    }

    void read_vertex() {
        if (vertices_.size() == 0xFFFFFFFF) lines_.refuse_line("a file has more than 2^32 - 1 vertices");
        lines_.cut('#');
        Point3d& place = vertices_.emplace_back();
        for (double& at : place) at = lines_.number("a coordinate");
    }

    void read_face() {
        lines_.cut('#');
        PlainMesh& mesh = parts_[current_].mesh;
        if (std::exchange(material_is_new_, false) && !material_.empty()) mesh.materials.insert(material_);
        for (std::string_view word = lines_.word(); !word.empty(); word = lines_.word())
            mesh.corners.push_back(corner_of(word));
        mesh.end_face();
    }

    /// Reads a polyline or points as faces of `corners` corners, so that they are never surface. A single corner is a point, too.
    void read_pieces(std::size_t corners) {
        read_face();
        PlainMesh& mesh = parts_[current_].mesh;
        const std::size_t begin = mesh.ends.size() < 2 ? 0 : std::size_t(mesh.ends[mesh.ends.size() - 2]);
        const std::vector<std::uint32_t> all(mesh.corners.begin() + std::ptrdiff_t(begin), mesh.corners.end());
        if (all.size() <= corners) return;
        mesh.corners.resize(begin);
        mesh.ends.pop_back();
        for (std::size_t i = 0; i + corners <= all.size(); ++i) {
            for (std::size_t k = 0; k < corners; ++k) mesh.corners.push_back(all[i + k]);
            mesh.end_face();
        }
    }

    /// Makes the mesh of the current group, or finds it if the file had this group before.
    void begin_part() {
        const std::string& group = group_.empty() ? object_ : group_;
        const std::string& object = object_.empty() ? group : object_;
        const auto [known, is_new] = numbers_.try_emplace({object, group}, parts_.size());
        current_ = known->second;
        material_is_new_ = true;
        if (!is_new) return;
        parts_.push_back({{}, object});
        parts_.back().mesh.name = group;
    }

    /// Returns the vertex of a corner "7", "7/1", "7//3" or "7/1/3". Negative numbers count back from the last vertex.
    std::uint32_t corner_of(std::string_view word) {
        std::int64_t number = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
        const bool whole = error == std::errc() && (end == word.data() + word.size() || *end == '/');
        if (!whole || number == 0) {
            lines_.refuse_line(fmt::format(
                "a corner of a face is '{}', not the number of a vertex; the first vertex is 1", shown(word)));
        }
        const auto count = std::int64_t(vertices_.size());
        if (number > 0xFFFFFFFF || number < -count) {
            lines_.refuse_line(
                fmt::format("a corner of a face is vertex {}, but there are {} before it", number, count));
        }
        if (number > largest_corner_) {
            largest_corner_ = number;
            line_of_largest_ = lines_.line_number();
        }
        return std::uint32_t(number > 0 ? number - 1 : count + number);
    }

    std::vector<PlainMesh> finish() {
        if (largest_corner_ > std::int64_t(vertices_.size())) {
            refuse(file_.path, fmt::format("line {}: a corner of a face is vertex {}, but the file has {}",
                                           line_of_largest_, largest_corner_, vertices_.size()));
        }
        std::erase_if(parts_, [](const ObjPart& part) { return part.mesh.ends.empty(); });
        name_equal_groups(parts_, file_);
        std::vector<PlainMesh> meshes;
        meshes.reserve(parts_.size());
        for (ObjPart& part : parts_) meshes.push_back(std::move(part.mesh));
        if (meshes.empty()) {  // points only
            meshes.emplace_back().vertices = std::move(vertices_);
        } else {
            give_vertices(meshes);
        }
        return meshes;
    }

    /// Copies to each mesh the vertices that it uses, in the order of their use.
    void give_vertices(std::vector<PlainMesh>& meshes) const {
        constexpr std::uint32_t unused = ~std::uint32_t(0);
        std::vector<std::uint32_t> numbers(vertices_.size(), unused);
        std::size_t corners = 0;
        for (PlainMesh& mesh : meshes) {
            std::vector<std::uint32_t> used;
            for (std::uint32_t& corner : mesh.corners) {
                if (++corners % 65536 == 0) file_.checkpoint(file_.bytes.size());
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
    bool capitals_;  // true if keywords may be capitals
    std::vector<Point3d> vertices_;
    std::vector<ObjPart> parts_;
    std::map<std::pair<std::string, std::string>, std::size_t> numbers_;  // indices of parts, by object and group
    std::size_t current_ = 0;                                             // part that faces are added to
    std::string object_, group_, material_;
    bool material_is_new_ = false;     // true if the current mesh may not have the material yet
    std::int64_t largest_corner_ = 0;  // largest positive number of a vertex that a corner refers to
    std::uint64_t line_of_largest_ = 0;
    UnreadLines unknown_, freeform_, calls_;
};

}  // namespace

std::vector<PlainMesh> parse_obj(const FileContent& file) { return ObjParser(file).parse(); }

}  // namespace octopair::io
