// parse_off(): the Object File Format of Geomview.
//
// A file is a stream of numbers: a vertex or a face may be on several lines, and several of them on one line. Only the colour of a face
// ends with its line. The keyword says how many numbers follow the coordinates of a vertex.
//
// - In most files, each vertex and each face has a line of its own. They are read by lines.
// - All other files are read as streams. A file does not state its whole layout, for example whether colours have three or four numbers.
//   The reader tries layouts. A layout is right if the last face ends at the end of the file.
// - If no layout is right, and the file can be read by lines, then the reader skips all other words after coordinates and corners.
#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/plain/text_lines.hpp"
#include "octopair/error.hpp"

namespace octopair::io {

namespace {

bool is_digits(std::string_view text) { return text.find_first_not_of("0123456789") == std::string_view::npos; }

/// The keyword at the begin of a word: OFF, after any of ST, C and N.
struct OffKeyword {
    std::size_t length = 0;  ///< 0: there is none
    bool colours = false;
    std::uint64_t other_numbers = 0;  ///< numbers of a vertex, besides its coordinates and its colour
};

/// A small n before OFF is not read: it means vertices with any number of coordinates.
OffKeyword keyword_of(std::string_view word) {
    OffKeyword found;
    for (std::size_t at = 0; at < word.size();) {
        const auto has = [&](std::string_view part) { return equal_in_any_case(word.substr(at, part.size()), part); };
        if (has("OFF")) {
            found.length = at + 3;
            return found;
        }
        if (has("ST")) {
            found.other_numbers += 2;
            at += 2;
        } else if (has("C")) {
            found.colours = true;
            ++at;
        } else if (word[at] == 'N') {
            found.other_numbers += 3;
            ++at;
        } else {
            break;
        }
    }
    return {};
}

/// Properties of the layout that the file does not state.
struct OffLayout {
    bool by_lines = true;        ///< each vertex and each face has a line of its own
    bool edges = true;           ///< the number of edges follows the number of faces on a later line
    bool face_colours = true;    ///< a face may have a colour, to the end of its line
    bool short_colours = false;  ///< colours of vertices have three numbers, not four
};

/// The content of a file, as it was read in one layout.
struct OffContent {
    PlainMesh mesh;
    OffKeyword keyword;
    std::uint64_t vertices = 0, faces = 0;
    bool edges_are_open = false;  ///< the line ends after the number of faces
    bool is_uniform = true;  ///< all vertices have the same number of words; after a face comes a colour or nothing
    bool is_stated = true;   ///< vertices have the number of words that the keyword states
    bool is_bare = true;     ///< no words follow vertices
    std::uint64_t unread_line = 0;  ///< first line after the last face; 0: none
    std::uint64_t last_line = 0;    ///< number of the last line that was read
    std::optional<Error> error;     ///< why the file is invalid in this layout

    bool is_complete() const { return !error && unread_line == 0; }
    /// Requires: the file was read by lines. Returns whether all lines are as the format says.
    bool has_lines() const { return !error && is_uniform && (is_stated || is_bare); }
};

/// Reads a file in one layout.
class OffParser {
public:
    OffParser(const FileContent& file, const OffLayout& layout) : file_(file), layout_(layout), lines_(file, '#') {}

    OffContent parse() {
        try {
            read();
        } catch (const Error& error) {
            if (error.code() != ErrorCode::bad_input) throw;
            content_.error = error;
        }
        content_.last_line = lines_.line_number();
        return std::move(content_);
    }

private:
    void read() {
        read_keyword();
        read_counts();
        PlainMesh& mesh = content_.mesh;
        mesh.vertices.reserve(content_.vertices);
        for (std::uint64_t i = 0; i < content_.vertices; ++i) read_vertex();
        mesh.ends.reserve(content_.faces);
        mesh.corners.reserve(3 * content_.faces);
        for (std::uint64_t i = 0; i < content_.faces; ++i) read_face();
        if (!lines_.rest().empty() || lines_.next()) content_.unread_line = lines_.line_number();
    }

    /// Reads the keyword, which may be missing. Goes to the counts.
    void read_keyword() {
        lines_.require_line("the header");
        const std::string_view word = lines_.peek();
        if (is_digits(word)) return;
        content_.keyword = keyword_of(word);
        const std::size_t length = content_.keyword.length;
        if (length == 0 || !is_digits(word.substr(length))) {
            lines_.refuse_line(
                fmt::format("the header is '{}'; octopair reads OFF with any of ST, C and N before it, that is "
                            "with three coordinates",
                            shown(word)));
        }
        lines_.skip(length);  // The number of vertices may follow without a space.
        if (equal_in_any_case(lines_.peek(), "BINARY")) {
            lines_.refuse_line("octopair reads OFF files as text only; save it as text");
        }
        lines_.find_word("the number of vertices");
    }

    void read_counts() {
        // The shortest vertices and faces are "0 0 0" and "0".
        const std::uint64_t most_vertices = std::min<std::uint64_t>(file_.bytes.size() / 6 + 1, 0xFFFFFFFF);
        content_.vertices = lines_.integer("the number of vertices", most_vertices);
        go_on("the number of faces");
        content_.faces = lines_.integer("the number of faces", file_.bytes.size() / 2 + 1);
        content_.edges_are_open = lines_.rest().empty();
        if (layout_.by_lines) {
            content_.is_uniform = lines_.skip_line() <= 1;  // the number of edges
        } else if (layout_.edges || !content_.edges_are_open) {
            go_on("the number of edges");
            (void)lines_.integer("the number of edges", std::numeric_limits<std::uint64_t>::max());
        }
    }

    void read_vertex() {
        begin("a vertex");
        Point3d& place = content_.mesh.vertices.emplace_back();
        for (double& at : place) {
            go_on("a coordinate");
            at = lines_.number("a coordinate");
        }
        if (layout_.by_lines) return compare_rest();
        const OffKeyword& stated = content_.keyword;
        const std::uint64_t colour = !stated.colours ? 0 : layout_.short_colours ? 3 : 4;
        skip_words(stated.other_numbers + colour, "a normal, a colour or a place in a texture");
    }

    /// Compares the number of words after a vertex with the number after the first vertex.
    void compare_rest() {
        const std::uint64_t words = lines_.skip_line();
        if (content_.mesh.vertices.size() == 1) words_after_vertex_ = words;
        content_.is_uniform &= words == words_after_vertex_;
        content_.is_stated &= is_stated(words);
        content_.is_bare &= words == 0;
    }
    /// Returns whether the keyword states that `words` numbers follow the coordinates of a vertex.
    bool is_stated(std::uint64_t words) const {
        const OffKeyword& stated = content_.keyword;
        if (!stated.colours) return words == stated.other_numbers;
        return words == stated.other_numbers + 3 || words == stated.other_numbers + 4;
    }

    void read_face() {
        begin("a face");
        const std::uint64_t corners = lines_.integer("the number of corners", file_.bytes.size());
        for (std::uint64_t k = 0; k < corners; ++k) {
            if (content_.vertices == 0) lines_.refuse_line("a face has corners, but there are no vertices");
            go_on("a corner");
            content_.mesh.corners.push_back(std::uint32_t(lines_.integer("a corner", content_.vertices - 1)));
        }
        content_.mesh.end_face();
        constexpr std::uint64_t most_of_colour = 4;
        if (layout_.face_colours) content_.is_uniform &= lines_.skip_line() <= most_of_colour;
    }

    /// Goes to the next vertex or face.
    void begin(std::string_view what) {
        if (layout_.by_lines) return lines_.require_line(what);
        lines_.find_word(what);
        constexpr std::uint64_t elements_between_checks = 4096;
        if (++elements_ % elements_between_checks == 0) lines_.checkpoint();
    }
    /// Goes to the next number of a vertex or face.
    void go_on(std::string_view what) {
        if (!layout_.by_lines) lines_.find_word(what);
    }
    void skip_words(std::uint64_t words, std::string_view what) {
        for (std::uint64_t i = 0; i < words; ++i) {
            lines_.find_word(what);
            (void)lines_.word();
        }
    }

    const FileContent& file_;
    OffLayout layout_;
    TextLines lines_;
    OffContent content_;
    std::uint64_t words_after_vertex_ = 0;
    std::uint64_t elements_ = 0;  // number of vertices and faces that a stream had so far
};

/// Returns the layouts to try for a stream; those that the format prescribes come first. `content`: result of reading by lines.
std::vector<OffLayout> stream_layouts(const OffContent& content) {
    constexpr OffLayout prescribed = {false, true, true, false};
    if (content.has_lines()) return {prescribed};
    std::vector<OffLayout> layouts;
    for (const bool edges : {true, false}) {
        if (!edges && !content.edges_are_open) continue;
        for (const bool short_colours : {false, true}) {
            if (short_colours && !content.keyword.colours) continue;
            for (const bool face_colours : {true, false})
                layouts.push_back({false, edges, face_colours, short_colours});
        }
    }
    return layouts;
}

/// Reads a file as a stream. Uses the first layout with which the last face ends the file; if there is none, the first layout.
OffContent read_stream(FileContent file, const OffContent& by_lines) {
    file.progress = {};  // Reading by lines has already reported the whole progress.
    std::optional<OffContent> best;
    for (const OffLayout& layout : stream_layouts(by_lines)) {
        OffContent content = OffParser(file, layout).parse();
        if (content.is_complete()) return content;
        if (!best) best = std::move(content);
    }
    return std::move(*best);
}

/// Returns the content of a file in the most likely layout. The content may have an error.
OffContent read_content(const FileContent& file) {
    OffContent by_lines = OffParser(file, {}).parse();
    if (by_lines.is_complete() && by_lines.has_lines()) return by_lines;
    OffContent stream = read_stream(file, by_lines);
    if (stream.is_complete()) return stream;
    if (!by_lines.error || !stream.error) return by_lines;
    // After the first vertices, the layout is certain, and an error is one of the file. Before, the layout that got further is likelier.
    if (by_lines.mesh.vertices.size() > 1) return by_lines.is_uniform ? std::move(by_lines) : std::move(stream);
    return stream.last_line <= by_lines.last_line ? std::move(by_lines) : std::move(stream);
}

}  // namespace

PlainMesh parse_off(const FileContent& file) {
    OffContent content = read_content(file);
    if (content.error) throw Error(*content.error);
    if (content.unread_line > 0) {
        file.warn(
            fmt::format("from line {} on it is not read, because the header says that it has {} vertices and {} faces",
                        content.unread_line, content.vertices, content.faces));
    }
    return std::move(content.mesh);
}

}  // namespace octopair::io
