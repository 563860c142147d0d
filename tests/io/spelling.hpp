// Spelling: the choices of a program that writes a file, at random: line ends, blanks, and forms of numbers. Generators of valid files use
// it, and know the content that a reader must find.
//
// Mutated files: a reader must answer, or describe the error in one line.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "io/meshes/plain/plain_mesh.hpp"
#include "octopair/error.hpp"
#include "samples/random.hpp"
#include "support/cases.hpp"
#include "support/scale.hpp"

namespace octopair::test {

/// Returns the number of files that each generator makes.
inline std::uint64_t generated_files() { return case_count(sanitized ? 500 : 10'000); }

/// Returns how to repeat the test of a file, and the file.
inline std::string repetition(std::uint64_t seed, const std::string& file) {
    return fmt::format("OCTOPAIR_TEST_SEED={}\n{}", seed, file);
}

/// Returns what a reader returns for a valid file. If it refuses the file, the test fails and shows it.
template <typename Read>
auto read_of_valid(std::uint64_t seed, const std::string& file, const Read& read) {
    try {
        return read();
    } catch (const Error& error) {
        ADD_FAILURE() << error.what() << '\n' << repetition(seed, file);
        return decltype(read())();
    }
}

/// A number of a text, and the value that the C library gives it.
struct SpelledNumber {
    std::string text;
    double value = 0;
};

class Spelling {
public:
    explicit Spelling(std::uint64_t seed) : random_(seed, 0), line_end_(pick({"\n", "\n", "\r\n", "\r"})) {}

    std::uint64_t below(std::uint64_t bound) { return random_.below(bound); }
    /// Returns true in one of `cases` cases.
    bool one_in(std::uint64_t cases) { return below(cases) == 0; }
    std::string pick(std::initializer_list<const char*> texts) { return texts.begin()[below(texts.size())]; }
    template <typename T>
    void shuffle(std::vector<T>& values) {
        for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[below(i)]);
    }

    /// Returns the end of all lines of the file.
    const std::string& line_end() const { return line_end_; }
    std::string byte_order_mark() { return one_in(4) ? "\xef\xbb\xbf" : ""; }
    std::string blank() { return pick({" ", " ", " ", "  ", "\t", " \t "}); }
    std::string indent() { return one_in(4) ? blank() : ""; }
    /// Returns a word in capitals, or as it is.
    std::string in_case(std::string word, bool capitals) {
        if (capitals) {
            for (char& c : word) c = c >= 'a' && c <= 'z' ? char(c - 'a' + 'A') : c;
        }
        return word;
    }

    /// Returns a finite number of any size, which is often whole.
    double number() {
        if (one_in(2)) return double(std::int64_t(below(2000)) - 1000);
        if (one_in(2)) return random_.uniform(-1000, 1000);
        const double any = std::bit_cast<double>(random_.next());
        return std::isfinite(any) ? any : -0.0;
    }
    /// Returns one of the texts of about this number.
    SpelledNumber spelled(double number) {
        std::string text = one_in(2)                              ? fmt::format("{}", number)
                           : std::fabs(number) < 1e6 && one_in(2) ? fmt::format("{:.{}f}", number, below(9))
                                                                  : fmt::format("{:.{}e}", number, below(18));
        if (one_in(8) && text[0] != '-') text.insert(0, "+");
        if (one_in(4)) std::replace(text.begin(), text.end(), 'e', 'E');
        const bool is_plain = text.find_first_of("eE") == std::string::npos;
        if (is_plain && one_in(4)) text += text.find('.') == std::string::npos ? "." : "000";
        if (text.starts_with("0.") && one_in(2)) text.erase(0, 1);
        if (text == ".") text = "0.";
        const double value = std::strtod(text.c_str(), nullptr);
        return std::isfinite(value) ? SpelledNumber{text, value} : SpelledNumber{"1e308", 1e308};  // rounded upwards
    }
    SpelledNumber spelled() { return spelled(number()); }

    /// Returns the text with up to three changes of bytes, words or its length.
    std::string mutated(std::string text) {
        for (std::uint64_t changes = 1 + below(3); changes > 0 && !text.empty(); --changes) {
            const std::size_t at = below(text.size());
            const std::size_t length = std::min<std::size_t>(1 + below(20), text.size() - at);
            switch (below(5)) {
                case 0:
                    text[at] = char(below(256));
                    break;
                case 1:
                    text[at] = "0123456789 -+.eE#/\\\"\n\r,;"[below(24)];
                    break;
                case 2:
                    text.erase(at, length);
                    break;
                case 3:
                    text.insert(below(text.size()), text.substr(at, length));
                    break;
                default:
                    if (one_in(4)) text.resize(at);
            }
        }
        return text;
    }

private:
    samples::RandomStream random_;
    std::string line_end_;
};

/// Returns what distinguishes two meshes; empty if they are equal to the bit.
inline std::string difference(const io::PlainMesh& read, const io::PlainMesh& written) {
    if (read.name != written.name) return fmt::format("name '{}', not '{}'", read.name, written.name);
    if (read.materials != written.materials) return read.name + ": materials";
    if (read.vertices.size() != written.vertices.size())
        return fmt::format("{} vertices, not {}", read.vertices.size(), written.vertices.size());
    for (std::size_t i = 0; i < read.vertices.size(); ++i) {
        if (std::memcmp(&read.vertices[i], &written.vertices[i], sizeof(Point3d)) != 0)
            return fmt::format("vertex {}", i);
    }
    if (read.corners != written.corners) return "corners";
    return read.ends != written.ends ? "ends of faces" : "";
}

inline std::string difference(const std::vector<io::PlainMesh>& read, const std::vector<io::PlainMesh>& written) {
    if (read.size() != written.size()) return fmt::format("{} meshes, not {}", read.size(), written.size());
    for (std::size_t i = 0; i < read.size(); ++i) {
        const std::string text = difference(read[i], written[i]);
        if (!text.empty()) return fmt::format("mesh {}: {}", i, text);
    }
    return "";
}

/// Returns what is wrong with a mesh that a reader made of any file; empty if nothing is.
inline std::string fault_of_mesh(const io::PlainMesh& mesh) {
    for (const std::uint32_t corner : mesh.corners) {
        if (corner >= mesh.vertices.size()) return "a corner is no vertex";
        for (const double at : mesh.vertices[corner]) {
            if (!std::isfinite(at)) return "a place is not finite";
        }
    }
    const bool sorted = std::is_sorted(mesh.ends.begin(), mesh.ends.end());
    return sorted && (mesh.ends.empty() ? mesh.corners.empty() : mesh.ends.back() == mesh.corners.size())
               ? ""
               : "faces do not end where corners end";
}

inline std::string fault_of_mesh(const std::vector<io::PlainMesh>& meshes) {
    for (const io::PlainMesh& mesh : meshes) {
        if (std::string wrong = fault_of_mesh(mesh); !wrong.empty()) return wrong;
    }
    return "";
}

/// Calls a reader. An Error must be one line that begins with `file`. Returns what is wrong; empty if nothing is.
template <typename Read>
std::string fault_of_reading(std::string_view file, const Read& read) {
    try {
        return read();
    } catch (const Error& error) {
        const std::string_view words = error.what();
        const bool is_clear = error.code() == ErrorCode::bad_input && words.starts_with(file) &&
                              std::none_of(words.begin(), words.end(), [](char c) { return c == '\n' || c == '\r'; });
        return is_clear ? "" : "an unclear error: " + std::string(words);
    }
}

}  // namespace octopair::test
