// Checks DirectX files for content that Assimp reads wrongly (correct_directx()).
#include "io/meshes/assimp/content/mesh_content.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/text_words.hpp"

namespace octopair::io {

namespace {

constexpr std::size_t x_header_bytes = 16, max_nested_frames = 1000;

/// The part of a frame that was read so far.
struct Frame {
    bool meshes = false;
    std::size_t frames = 0;
};

class DirectxCheck {
public:
    DirectxCheck(const std::string& path, std::string_view text) : text_(text), tokens_(path, text, "{};,", '#') {
        while (tokens_.peek().offset < x_header_bytes && !tokens_.peek().text.empty()) tokens_.next();
    }

    MeshContent check() {
        for (TextToken token = tokens_.next(); !token.text.empty(); token = tokens_.next()) check_object(token, file_);
        if (file_.meshes && file_.frames == 1) insertions_.emplace_back(text_.size(), "\nFrame { }\n");
        MeshContent content;
        content.left_out = left_out_.list();
        if (!insertions_.empty()) content.text = corrected();
        return content;
    }

private:
    /// Reads an object of the file, or of a frame. Notes in `parent` which kind of object it was.
    void check_object(const TextToken& type, Frame& parent) {
        if (type.text == "}" || type.text == ";" || type.text == ",") return;
        if (type.text == "{") {
            tokens_.refuse(type.line, fmt::format("the reference to '{}' is not read; export the object in its place",
                                                  shown(tokens_.next().text)));
        }
        if (type.text == "Frame") {
            ++parent.frames;
            check_frame(type, parent);
        } else if (type.text == "Mesh") {
            parent.meshes = true;
            open(type);
            check_mesh();
        } else if (type.text == "FrameTransformMatrix") {
            open(type);
            check_matrix();
        } else {
            skip_other(type);
        }
    }

    /// Reads the name of an object and its brace. Returns whether the object has a name.
    bool open(const TextToken& type) {
        TextToken token = tokens_.next();
        const bool named = token.text != "{";
        if (named) token = tokens_.next();
        if (token.text != "{") tokens_.refuse(type.line, fmt::format("'{}' without a brace", shown(type.text)));
        return named;
    }

    void check_frame(const TextToken& type, Frame& parent) {
        if (++depth_ > max_nested_frames)
            tokens_.refuse(type.line, fmt::format("more than {} frames are nested", max_nested_frames));
        const bool named = open(type);
        const std::size_t name_place = type.offset + type.text.size();
        Frame frame;
        for (TextToken token = tokens_.next(); token.text != "}"; token = tokens_.next()) {
            if (token.text.empty()) tokens_.refuse(type.line, "the frame does not end: the file is cut");
            check_object(token, frame);
        }
        if (!named && frame.meshes && frame.frames > 0 && &parent != &file_)
            insertions_.emplace_back(name_place, fmt::format(" unnamed_{}", insertions_.size()));
        --depth_;
    }

    /// Puts a space after each comma, so that Assimp does not read the comma as a decimal point.
    void check_matrix() {
        for (TextToken token = tokens_.next(); token.text != "}"; token = tokens_.next()) {
            if (token.text.empty() || token.text == "{") tokens_.refuse(token.line, "the matrix does not end");
            const std::size_t after = token.offset + 1;
            if (token.text == "," && after < text_.size() && text_[after] >= '0' && text_[after] <= '9')
                insertions_.emplace_back(after, " ");
        }
    }

    void check_mesh() {
        const std::size_t vertices = tokens_.count();
        for (std::size_t i = 0; i < vertices; ++i) skip_vector();
        const std::size_t faces = tokens_.count();
        for (std::size_t i = 0; i < faces; ++i) {
            for (std::size_t corners = tokens_.count(); corners > 0; --corners) {
                while (tokens_.peek().text == ";" || tokens_.peek().text == ",") tokens_.next();
                const std::size_t line = tokens_.peek().line;
                const double index = tokens_.number();
                if (index >= 0 && index < double(vertices)) continue;
                tokens_.refuse(line, fmt::format("a face refers to vertex {}, but the mesh has {} vertices",
                                                 number_text(index), vertices));
            }
        }
        check_parts(faces);
    }

    /// Skips three coordinates. A comma within a coordinate is a decimal point, because each coordinate ends with a semicolon.
    void skip_vector() {
        for (int axis = 0; axis < 3; ++axis) {
            while (tokens_.peek().text == ";" || tokens_.peek().text == ",") tokens_.next();
            const bool whole = tokens_.peek().text.find_first_of(".eE") == std::string_view::npos;
            tokens_.number();
            if (!whole || tokens_.peek().text != ",") continue;
            tokens_.next();
            if (tokens_.peek().text != ";") tokens_.number();
        }
    }

    /// Reads the parts of a mesh after its faces, up to the end of the mesh.
    void check_parts(std::size_t faces) {
        for (TextToken token = tokens_.next(); token.text != "}"; token = tokens_.next()) {
            if (token.text.empty()) tokens_.refuse(token.line, "the mesh does not end: the file is cut");
            if (token.text == ";" || token.text == ",") continue;
            if (token.text == "MeshMaterialList") {
                open(token);
                check_materials(faces);
            } else {
                if (token.text == "XSkinMeshHeader") left_out_.add("deformations of skins");
                if (token.text == "{")
                    tokens_.refuse(token.line, "a reference in a mesh is not read; export the object in its place");
                skip_other(token);
            }
        }
    }

    void check_materials(std::size_t faces) {
        tokens_.count();
        std::size_t largest = 0, line = 0;
        const std::size_t indices = tokens_.count();
        for (std::size_t i = 0; i < indices; ++i) {
            const std::size_t index = tokens_.count();
            if (index >= largest) largest = index, line = tokens_.peek().line;
        }
        std::size_t materials = 0;
        for (TextToken token = tokens_.next(); token.text != "}"; token = tokens_.next()) {
            if (token.text.empty()) tokens_.refuse(token.line, "the list of materials does not end: the file is cut");
            if (token.text == "{") {
                ++materials;
                while (tokens_.peek().text != "}" && !tokens_.peek().text.empty()) tokens_.next();
                tokens_.next();
            } else if (token.text != ";" && token.text != ",") {
                materials += token.text == "Material";
                skip_other(token);
            }
        }
        if (faces > 0 && indices > 0 && largest >= std::max<std::size_t>(materials, 1)) {
            tokens_.refuse(line,
                           fmt::format("a face has material {}, but the mesh has {} materials; its faces would be lost",
                                       largest, materials));
        }
    }

    /// Skips an object of any other type, with its content.
    void skip_other(const TextToken& type) {
        bool meshes = false;
        TextToken token = tokens_.next();
        while (token.text != "{" && !token.text.empty()) token = tokens_.next();
        for (std::size_t depth = 1; depth > 0;) {
            token = tokens_.next();
            if (token.text.empty())
                tokens_.refuse(type.line, fmt::format("'{}' does not end: the file is cut", shown(type.text)));
            if (token.text == "{") ++depth;
            if (token.text == "}") --depth;
            meshes |= token.text == "Mesh";
        }
        const bool patches = type.text.find("PatchMesh") != std::string_view::npos;
        if (type.text != "template" && (meshes || patches))
            left_out_.add(fmt::format("objects of type {}", shown(type.text)));
    }

    std::string corrected() const {
        std::string text;
        std::size_t from = 0;
        std::vector<std::pair<std::size_t, std::string>> sorted = insertions_;
        std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
        for (const auto& [offset, words] : sorted) {
            text.append(text_.substr(from, offset - from)).append(words);
            from = offset;
        }
        return text.append(text_.substr(from));
    }

    std::string_view text_;
    TextTokens tokens_;
    Frame file_;
    std::size_t depth_ = 0;
    LeftOut left_out_;
    std::vector<std::pair<std::size_t, std::string>> insertions_;  // offset in the file, and the text to insert there
};

}  // namespace

MeshContent correct_directx(const std::string& path, std::string_view bytes) {
    if (!bytes.starts_with("xof ") || bytes.size() < x_header_bytes || bytes.substr(8, 3) != "txt") return {};
    return DirectxCheck(path, bytes).check();
}

}  // namespace octopair::io
