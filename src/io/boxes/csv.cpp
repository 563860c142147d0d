#include "io/boxes/csv.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/files/input_file.hpp"

namespace octopair::io {

namespace {

constexpr std::size_t columns = 6;

std::string_view trimmed(std::string_view text) {
    const std::size_t begin = text.find_first_not_of(" \t");
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

enum class Verdict : std::uint8_t { number, beyond_range, no_number };

Verdict parse_number(std::string_view field, double& value) {
    if (field.size() > 1 && field[0] == '+' && field[1] != '-') field.remove_prefix(1);
    const char* end = field.data() + field.size();
    const auto [stop, error] = std::from_chars(field.data(), end, value);
    if (error == std::errc::invalid_argument || stop != end) return Verdict::no_number;
    const bool written_infinite = field.find_first_of("iI") != std::string_view::npos;
    if (error == std::errc::result_out_of_range || (std::isinf(value) && !written_infinite)) {
        return Verdict::beyond_range;
    }
    return Verdict::number;
}

/// Splits a line into six fields. Throws: Error{bad_input} if the line does not have six fields.
std::array<std::string_view, columns> split(std::string_view line, std::string_view place) {
    const std::size_t found = std::size_t(std::count(line.begin(), line.end(), ',')) + 1;
    if (found != columns) refuse(place, fmt::format("{} fields, not {} numbers", found, columns));
    std::array<std::string_view, columns> fields;
    for (std::string_view& field : fields) {
        const std::size_t comma = std::min(line.find(','), line.size());
        field = trimmed(line.substr(0, comma));
        line.remove_prefix(std::min(comma + 1, line.size()));
    }
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

/// Parses a line of any form. Returns false for the header. `place` is the file and the line.
/// Throws: Error{bad_input}.
bool parse_any(std::string_view line, bool first, std::string_view place, Numbers& numbers) {
    const auto fields = split(line, place);
    std::array<Verdict, columns> verdicts;
    for (std::size_t i = 0; i < columns; ++i) verdicts[i] = parse_number(fields[i], numbers[i]);
    const auto is_word = [](Verdict verdict) { return verdict == Verdict::no_number; };
    if (first && std::all_of(verdicts.begin(), verdicts.end(), is_word)) return false;
    for (std::size_t i = 0; i < columns; ++i) {
        if (verdicts[i] == Verdict::number) continue;
        refuse(place, fmt::format("field {} {}: '{}'", i + 1,
                                  is_word(verdicts[i]) ? "is not a number" : "is outside the range of float64",
                                  shown(fields[i])));
    }
    return true;
}

}  // namespace

Buffer<Box3d> parse_csv_boxes(std::string_view text, std::string_view file, const std::stop_token& stop) {
    constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
    if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
    Buffer<Box3d> boxes{std::size_t(std::count(text.begin(), text.end(), '\n')) + 1};
    std::size_t size = 0;
    for (std::uint64_t number = 1; !text.empty(); ++number) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        if (line.ends_with('\r')) line.remove_suffix(1);
        if (number % 65536 == 0 && stop.stop_requested()) cancel();
        if (trimmed(line).empty()) continue;
        Numbers numbers;
        if (!parse_plain(line, numbers) &&
            !parse_any(line, number == 1, fmt::format("{}: line {}", file, number), numbers)) {
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
