// Checks AC3D files for content that Assimp reads wrongly (correct_ac3d()).
#include "io/meshes/assimp/content/mesh_content.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/text_words.hpp"

namespace octopair::io {

namespace {

/// The part of an object that was read so far.
struct Ac3dObject {
    std::size_t line = 0;
    std::size_t vertices = 0;
    bool moved = false, turned = false, lines = false, surfaces = false;
    std::vector<double> place;                   // loc
    std::string_view place_line;                 // the text after loc
    std::vector<std::string_view> vertex_lines;  // with three numbers each
};

class Ac3dCheck {
public:
    Ac3dCheck(const std::string& path, std::string_view text) : path_(path), whole_text_(text), text_(text) {}

    MeshContent check() {
        while (!text_.empty()) check_line(take_line());
        MeshContent content;
        if (!corrections_.empty()) content.text = corrected();
        return content;
    }

private:
    std::string_view take_line() {
        const std::size_t end = std::min(text_.find('\n'), text_.size());
        const std::string_view line = text_.substr(0, end);
        text_.remove_prefix(std::min(end + 1, text_.size()));
        ++line_;
        return line;
    }

    void check_line(std::string_view line) {
        const std::string_view word = take_list_word(line);
        if (word == "MATERIAL") ++materials_;
        if (word == "OBJECT") begin_object();
        if (word == "loc") set_place(line);
        if (word == "rot") object_.turned = has_other(numbers_of(line).numbers, {1, 0, 0, 0, 1, 0, 0, 0, 1});
        if (word == "data") skip_data(whole(line));
        if (word == "numvert") read_vertices(whole(line));
        if (word == "SURF") object_.lines |= is_line(line);
        if (word == "mat") check_material(whole(line));
        if (word == "refs") check_corners(whole(line));
        if (word == "kids") check_object(whole(line));
    }

    static bool has_other(const std::vector<double>& numbers, const std::vector<double>& usual) {
        return !numbers.empty() && numbers != usual;
    }

    std::size_t whole(std::string_view line) const {
        const std::string_view word = take_list_word(line);
        std::size_t number = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
        if (error != std::errc() || end != word.data() + word.size())
            refuse(path_, fmt::format("line {}: '{}' is in the place of a whole number", line_, shown(word)));
        return number;
    }

    /// Returns whether the flags of a surface mark it as a line.
    static bool is_line(std::string_view line) {
        std::string_view word = take_list_word(line);
        const int base = word.starts_with("0x") || word.starts_with("0X") ? 16 : 10;
        if (base == 16) word.remove_prefix(2);
        unsigned flags = 0;
        std::from_chars(word.data(), word.data() + word.size(), flags, base);
        return (flags & 0xF) == 1 || (flags & 0xF) == 2;
    }

    void begin_object() {
        object_ = {};
        object_.line = line_;
    }

    void set_place(std::string_view line) {
        object_.place = numbers_of(line).numbers;
        object_.place_line = line;
        object_.moved = has_other(object_.place, {0, 0, 0});
    }

    void read_vertices(std::size_t count) {
        object_.vertices = count;
        for (; count > 0 && !text_.empty(); --count) object_.vertex_lines.push_back(take_line());
    }

    /// Skips the characters of a text. If a line of the text begins with a keyword, Assimp reads this line as a part of the model.
    void skip_data(std::size_t characters) {
        constexpr std::array<std::string_view, 11> keywords = {"MATERIAL", "OBJECT",  "kids", "loc", "rot", "name",
                                                               "numvert",  "numsurf", "SURF", "mat", "refs"};
        const std::size_t end = text_.size() - std::min(characters, text_.size());
        while (text_.size() > end) {
            std::string_view line = take_line();
            const std::string_view word = take_list_word(line);
            if (std::find(keywords.begin(), keywords.end(), word) == keywords.end()) continue;
            refuse(
                path_,
                fmt::format(
                    "line {}: the data of an object begin with '{}', which Assimp reads as the model; remove the data",
                    line_, word));
        }
    }

    void check_material(std::size_t material) {
        if (material < std::max<std::size_t>(materials_, 1)) return;
        refuse(path_, fmt::format("line {}: a surface has material {}, but the file has {} materials", line_, material,
                                  materials_));
    }

    void check_corners(std::size_t count) {
        object_.surfaces = true;
        for (; count > 0 && !text_.empty(); --count) {
            const std::size_t vertex = whole(take_line());
            if (vertex < object_.vertices) continue;
            refuse(path_, fmt::format("line {}: a surface refers to vertex {}, but the object has {} vertices", line_,
                                      vertex, object_.vertices));
        }
    }

    /// Checks an object at its end.
    void check_object(std::size_t kids) {
        const bool in_place = object_.moved && object_.surfaces;
        if (object_.turned || (in_place && kids > 0)) {
            refuse(path_,
                   fmt::format(
                       "line {}: the place of an object with {} is read wrongly; export its vertices in their places",
                       object_.line, object_.turned ? "a rotation (rot)" : "children"));
        }
        if (in_place && object_.lines) move_vertices();
        begin_object();  // so that a second line "kids" of the object has no effect
    }

    /// Adds the place of an object to the coordinates of its vertices.
    void move_vertices() {
        for (const std::string_view line : object_.vertex_lines) {
            const std::vector<double> at = numbers_of(line).numbers;
            if (at.size() < 3 || object_.place.size() != 3) return;
            corrections_.emplace_back(line, fmt::format("{} {} {}", at[0] + object_.place[0], at[1] + object_.place[1],
                                                        at[2] + object_.place[2]));
        }
        corrections_.emplace_back(object_.place_line, " 0 0 0");
    }

    std::string corrected() {
        std::sort(corrections_.begin(), corrections_.end(),
                  [](const auto& a, const auto& b) { return a.first.data() < b.first.data(); });
        std::string text;
        const char* from = whole_text_.data();
        for (const auto& [part, words] : corrections_) {
            text.append(from, part.data()).append(words);
            from = part.data() + part.size();
        }
        return text.append(from, whole_text_.data() + whole_text_.size());
    }

    const std::string& path_;
    std::string_view whole_text_, text_;  // text_: the part that was not read yet
    std::size_t line_ = 0, materials_ = 0;
    Ac3dObject object_;
    std::vector<std::pair<std::string_view, std::string>> corrections_;  // part of the text, and its replacement
};

}  // namespace

MeshContent correct_ac3d(const std::string& path, std::string_view bytes) { return Ac3dCheck(path, bytes).check(); }

}  // namespace octopair::io
