#include "io/boxes/csv.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/files/input_file.hpp"
#include "io/files/line_splitter.hpp"

namespace octopair::io {

namespace {

constexpr std::size_t columns = 6;

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_digit_or_point(char c) { return is_digit(c) || c == '.'; }

std::string_view trimmed(std::string_view text) {
    const std::size_t begin = text.find_first_not_of(" \t");
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

/// Returns a field without its quotes, if it has any.
std::string_view unquoted(std::string_view field) {
    if (field.size() < 2 || field.front() != '"' || field.back() != '"') return field;
    return trimmed(field.substr(1, field.size() - 2));
}

enum class Verdict : std::uint8_t { number, beyond_range, no_number };

/// Parses a number. Fortran writes the exponent of a double with D.
Verdict parse_number(std::string_view field, double& value) {
    if (field.size() > 1 && field[0] == '+' && field[1] != '-') field.remove_prefix(1);
    std::string with_e(field);
    const std::size_t exponent = with_e.find_first_of("dD");
    if (exponent != std::string::npos && exponent > 0 && is_digit_or_point(with_e[exponent - 1]))
        with_e[exponent] = 'e';
    const char* const end = with_e.data() + with_e.size();
    const auto [stop, error] = std::from_chars(with_e.data(), end, value);
    if (error == std::errc::invalid_argument || stop != end) return Verdict::no_number;
    const bool written_infinite = field.find_first_of("iI") != std::string_view::npos;
    if (error == std::errc::result_out_of_range || (std::isinf(value) && !written_infinite)) {
        return Verdict::beyond_range;
    }
    return Verdict::number;
}

/// Returns whether a field that is no number was possibly meant as a number: its first letter or digit is a digit.
bool resembles_number(std::string_view field) {
    const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
    const auto first = std::find_if(field.begin(), field.end(), [&](char c) { return is_letter(c) || is_digit(c); });
    return first != field.end() && is_digit(*first);
}

/// Returns the length of the first field of a line: up to a comma that is not in quotes.
std::size_t field_length(std::string_view line) {
    bool quoted = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (line[i] == '"') quoted = !quoted;
        if (line[i] == ',' && !quoted) return i;
    }
    return line.size();
}

/// Returns what to do about a line with other separators than commas; empty for other lines.
std::string_view separator_hint(std::string_view line) {
    const std::string_view text = trimmed(line);
    const bool has_commas = text.find(',') != std::string_view::npos;
    if (text.find_first_of(has_commas ? ";\t" : "; \t") == std::string_view::npos) return "";
    return "; separate the numbers with commas, and write them with a point";
}

/// Splits a line into six fields. Throws: Error{bad_input} if the line does not have six fields.
std::array<std::string_view, columns> split(std::string_view line, std::string_view place) {
    std::array<std::string_view, columns> fields;
    std::size_t found = 0;
    std::string_view left = line;
    for (bool more = true; more; ++found) {
        const std::size_t length = field_length(left);
        if (found < columns) fields[found] = unquoted(trimmed(left.substr(0, length)));
        more = length < left.size();
        left.remove_prefix(std::min(length + 1, left.size()));
    }
    if (found != columns)
        refuse(place, fmt::format("{} fields, not {} numbers{}", found, columns, separator_hint(line)));
    return fields;
}

using Numbers = std::array<double, columns>;

/// Fast path: parses lines of the form "1,2,3,4,5,6" with finite numbers. Returns false for all other lines.
bool parse_plain(std::string_view line, Numbers& numbers) {
    const char* at = line.data();
    const char* const end = at + line.size();
    for (double& number : numbers) {
        const auto [stop, error] = std::from_chars(at, end, number);
        if (error != std::errc() || !std::isfinite(number)) return false;
        if (&number == &numbers.back()) return stop == end;
        if (stop == end || *stop != ',') return false;
        at = stop + 1;
    }
    return false;
}

/// Returns whether six fields are a header: some are not empty, and none resembles a number.
bool is_header(const std::array<std::string_view, columns>& fields, const std::array<Verdict, columns>& verdicts) {
    bool is_named = false;
    for (std::size_t i = 0; i < columns; ++i) {
        if (verdicts[i] != Verdict::no_number || resembles_number(fields[i])) return false;
        is_named |= !fields[i].empty();
    }
    return is_named;
}

/// Parses a line of any form. Returns false for the header. `place` is the file and the line.
/// Throws: Error{bad_input}.
bool parse_any(std::string_view line, bool first, std::string_view place, Numbers& numbers) {
    const auto fields = split(line, place);
    std::array<Verdict, columns> verdicts;
    for (std::size_t i = 0; i < columns; ++i) verdicts[i] = parse_number(fields[i], numbers[i]);
    if (first && is_header(fields, verdicts)) return false;
    for (std::size_t i = 0; i < columns; ++i) {
        if (verdicts[i] == Verdict::number) continue;
        const bool is_word = verdicts[i] == Verdict::no_number;
        refuse(place, fmt::format("field {} {}: '{}'{}", i + 1,
                                  is_word ? "is not a number" : "is outside the range of float64", shown(fields[i]),
                                  separator_hint(line)));
    }
    return true;
}

}  // namespace

Buffer<Box3d> parse_csv_boxes(std::string_view text, std::string_view file, const std::stop_token& stop) {
    Buffer<Box3d> boxes{std::size_t(most_lines(text))};
    std::size_t size = 0;
    for (LineSplitter lines(text); lines.next();) {
        if (lines.number() % 65536 == 0 && stop.stop_requested()) cancel();
        const std::string_view line = lines.line();
        if (trimmed(line).empty()) continue;
        Numbers numbers;
        if (!parse_plain(line, numbers) &&
            !parse_any(line, lines.number() == 1, fmt::format("{}: line {}", file, lines.number()), numbers)) {
            continue;
        }
        boxes[size++] = {{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]}};
    }
    boxes.resize_discard(size);
    return boxes;
}

LoadedScene read_csv_scene(const std::string& path, const std::stop_token& stop) {
    const InputFile file(path);
    Buffer<char> text{std::size_t(file.size())};
    file.read(0, std::as_writable_bytes(text.span()), stop);
    LoadedScene scene;
    Buffer<Box3d> boxes = parse_csv_boxes({text.data(), text.size()}, path, stop);
    scene.objects = boxes.size();
    scene.boxes = std::move(boxes);
    return scene;
}

}  // namespace octopair::io
