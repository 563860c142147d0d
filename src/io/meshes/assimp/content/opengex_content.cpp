// Checks OpenGEX files for content that Assimp reads wrongly or leaves out (check_opengex()).
#include "io/meshes/assimp/content/mesh_content.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <vector>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/text_words.hpp"

namespace octopair::io {

namespace {

/// A structure that has begun and not ended, and the part of its content that was read so far.
struct OpenStructure {
    std::string_view type;
    std::size_t line = 0;
    std::size_t transforms = 0, index_arrays = 0;
    std::size_t positions = 0;
    std::uint64_t largest_index = 0;
    std::size_t index_line = 0;
};

class OpengexCheck {
public:
    OpengexCheck(const std::string& path, std::string_view text) : tokens_(path, text, "{}()[]=,") {}

    MeshContent check() {
        for (TextToken token = tokens_.next(); !token.text.empty(); token = tokens_.next()) {
            if (token.text == "}") {
                close();
            } else if (is_name(token.text)) {
                begin(token);
            } else if (token.text == "{") {
                open_.push_back({"", token.line});
            }
        }
        return {std::nullopt, {}, left_out_.list()};
    }

private:
    static bool is_name(std::string_view text) {
        return (text[0] >= 'a' && text[0] <= 'z') || (text[0] >= 'A' && text[0] <= 'Z');
    }

    bool is_within_node() const {
        return std::any_of(open_.begin(), open_.end(),
                           [](const OpenStructure& open) { return open.type.ends_with("Node"); });
    }

    /// Reads the head of a structure, or of a list of numbers.
    void begin(const TextToken& type) {
        std::vector<std::string_view> head;  // names, properties and sizes
        TextToken token = tokens_.next();
        for (; token.text != "{"; token = tokens_.next()) {
            if (token.text.empty()) return;
            head.push_back(token.text);
        }
        const auto has = [&](std::string_view word) { return std::find(head.begin(), head.end(), word) != head.end(); };
        check_place(type);
        open_.push_back({type.text, type.line});
        const std::string_view owner = open_.size() > 1 ? open_[open_.size() - 2].type : std::string_view();
        if (type.text == "Mesh" && has("primitive") && !has("\"triangles\""))
            tokens_.refuse(type.line, "only meshes of triangles are read; triangulate the model before the export");
        if (type.text == "Transform" && has("object"))
            tokens_.refuse(type.line, "a transform of an object alone is read wrongly; apply it before the export");
        if (owner == "IndexArray") check_indices(head, type);
        if (type.text == "VertexArray" && has("\"position\"")) in_positions_ = true;
        if (owner == "VertexArray" && in_positions_) count_positions();
    }

    void check_place(const TextToken& type) {
        if (open_.empty()) return;
        OpenStructure& owner = open_.back();
        const bool in_node = owner.type.ends_with("Node");
        if (type.text == "GeometryNode" && is_within_node()) left_out_.add("geometry within other nodes");
        if (in_node && (type.text == "Translation" || type.text == "Rotation" || type.text == "Scale"))
            tokens_.refuse(type.line,
                           fmt::format("{} is not read; export the node with a Transform of 16 numbers", type.text));
        if (in_node && type.text == "Transform" && ++owner.transforms > 1)
            tokens_.refuse(type.line, "a node with several transforms is read wrongly; export it with one");
        if (owner.type == "Mesh" && type.text == "IndexArray" && ++owner.index_arrays > 1)
            tokens_.refuse(type.line,
                           "a mesh with several index arrays is read wrongly; export a mesh for each material");
    }

    /// Counts the groups of three numbers of a list, and closes the list.
    void count_positions() {
        std::size_t depth = 1;
        std::size_t groups = 0;
        for (TextToken token = tokens_.next(); !token.text.empty(); token = tokens_.next()) {
            if (token.text == "{" && ++depth == 2) ++groups;
            if (token.text == "}" && --depth == 0) break;
        }
        open_.pop_back();
        in_positions_ = false;
        for (auto at = open_.rbegin(); at != open_.rend(); ++at) {
            if (at->type == "Mesh") at->positions = groups;
        }
    }

    /// Reads a list of faces, and closes the list.
    void check_indices(const std::vector<std::string_view>& head, const TextToken& type) {
        if (head.size() < 3 || head[0] != "[" || head[1] != "3")
            tokens_.refuse(type.line,
                           "only faces with three corners are read; triangulate the model before the export");
        std::size_t depth = 1;
        std::uint64_t largest = 0;
        std::size_t line = type.line;
        for (TextToken token = tokens_.next(); !token.text.empty(); token = tokens_.next()) {
            if (token.text == "{") ++depth;
            if (token.text == "}" && --depth == 0) break;
            if (token.text.starts_with('0') && token.text.size() > 1)
                tokens_.refuse(token.line,
                               fmt::format("the index {} is read wrongly; export decimal numbers", shown(token.text)));
            const std::uint64_t index = whole(token.text);
            if (index > largest) largest = index, line = token.line;
        }
        open_.pop_back();
        for (OpenStructure& open : open_) {
            if (open.type == "Mesh") open.largest_index = largest, open.index_line = line;
        }
    }

    static std::uint64_t whole(std::string_view text) {
        std::uint64_t value = 0;
        std::from_chars(text.data(), text.data() + text.size(), value);
        return value;
    }

    void close() {
        if (open_.empty()) return;
        const OpenStructure structure = open_.back();
        open_.pop_back();
        if (structure.type != "Mesh") return;
        if (structure.index_arrays == 0 && structure.positions > 0)
            tokens_.refuse(structure.line, "a mesh without an index array is not read; export it with one");
        if (structure.index_arrays > 0 && structure.largest_index >= structure.positions) {
            tokens_.refuse(structure.index_line, fmt::format("a face refers to vertex {}, but the mesh has {} vertices",
                                                             structure.largest_index, structure.positions));
        }
    }

    TextTokens tokens_;
    std::vector<OpenStructure> open_;
    bool in_positions_ = false;  // true while reading the array of the positions
    LeftOut left_out_;
};

}  // namespace

MeshContent check_opengex(const std::string& path, std::string_view bytes) { return OpengexCheck(path, bytes).check(); }

}  // namespace octopair::io
