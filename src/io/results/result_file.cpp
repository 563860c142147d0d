#include "io/results/result_file.hpp"

#include <algorithm>
#include <charconv>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/memory.hpp"
#include "base/stop.hpp"
#include "io/boxes/npy_header.hpp"
#include "io/files/failure.hpp"
#include "io/files/input_file.hpp"
#include "io/formats/format_choice.hpp"
#include "io/json/json_fields.hpp"
#include "io/results/collision_columns.hpp"
#include "octopair/error.hpp"

namespace octopair::io {

namespace {

constexpr std::uint64_t max_result_frames = 1'000'000;
constexpr std::uint32_t max_index = 0xFFFFFFFE;

std::string read_text(const InputFile& file, std::uint64_t most, const std::stop_token& stop) {
    std::string text(std::size_t(std::min(most, file.size())), '\0');
    file.read(0, std::as_writable_bytes(std::span(text)), stop);
    return text;
}

NpyHeader header_of(const InputFile& file) {
    const std::string head = read_text(file, npy_header_max_bytes, {});
    return parse_npy_header(std::as_bytes(std::span(head)), file.size(), file.path());
}

bool holds_pairs(const NpyHeader& header) {
    return (header.type == NpyType::uint32 || header.type == NpyType::uint64) && header.shape.size() == 2 &&
           header.shape[1] == 2;
}

/// Splits a line of CSV into fields. Quotes are removed.
std::vector<std::string> csv_fields(std::string_view line) {
    std::vector<std::string> fields(1);
    bool quoted = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const char c = line[i];
        if (c == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"') {
            fields.back() += line[++i];
        } else if (c == '"') {
            quoted = !quoted;
        } else if (c == ',' && !quoted) {
            fields.emplace_back();
        } else {
            fields.back() += c;
        }
    }
    return fields;
}

bool is_result_header(std::string_view line) {
    const std::vector<std::string> fields = csv_fields(line);
    const auto has = [&](std::string_view name) {
        return std::find(fields.begin(), fields.end(), name) != fields.end();
    };
    return has("a") && has("b");
}

std::optional<Event> event_of(std::string_view word, const std::string& place) {
    if (word.empty()) return std::nullopt;
    if (word == "begin") return Event::begin;
    if (word == "end") return Event::end;
    refuse(place, fmt::format("event '{}': neither begin nor end", shown_text(word)));
}

/// Collects the rows of a file of results. Refuses rows that no search can give, such as an object that collides with itself.
class ResultBuilder {
public:
    explicit ResultBuilder(std::string file) : file_(std::move(file)) {}

    /// Adds the row of a collision, whose pair and finding `row` still lacks.
    void add(ResultRow row, const CollisionRecord& collision, const std::string& place) {
        for (const RecordedObject* object : {&collision.a, &collision.b}) {
            if (!object->name.empty()) result_.names.emplace(object->number, object->name);
        }
        row.pair = {collision.a.number, collision.b.number};
        row.finding = finding_of(collision);
        add(std::move(row), place);
    }
    void add(ResultRow row, const std::string& place) {
        if (row.pair.a == row.pair.b) refuse(place, "a and b are the same object");
        if (row.pair.a > row.pair.b) std::swap(row.pair.a, row.pair.b);
        if (row.pair.b > max_index) refuse(place, "the index is too large");
        if (row.frame >= max_result_frames)
            refuse(place, fmt::format("frame {}: at most {} frames", row.frame, max_result_frames));
        result_.objects = std::max<std::uint64_t>(result_.objects, std::uint64_t(row.pair.b) + 1);
        result_.frames.add(std::move(row));
    }
    void set_moving() { result_.moving = true; }
    void set_first_frame(std::uint32_t frame) {
        result_.moving = true;
        result_.first_frame = frame;
    }

    ResultFile finish() {
        if (!result_.frames.finish()) refuse(file_, "some rows have events, and some have none");
        return std::move(result_);
    }

private:
    std::string file_;
    ResultFile result_;
};

template <typename Index>
void add_npy_rows(const InputFile& file, const NpyHeader& header, ResultBuilder& builder, const std::stop_token& stop) {
    Buffer<Index> numbers{std::size_t(header.shape[0] * 2)};
    file.read(header.data_offset, std::as_writable_bytes(numbers.span()), stop);
    for (std::size_t i = 0; i < numbers.size(); i += 2) {
        const std::string place = fmt::format("{}: row {}", file.path(), i / 2);
        if (std::max<std::uint64_t>(numbers[i], numbers[i + 1]) > max_index) refuse(place, "the index is too large");
        builder.add({.pair = {std::uint32_t(numbers[i]), std::uint32_t(numbers[i + 1])}}, place);
    }
}

/// Returns the frame number in the name of a file, such as 3 in pairs.000003.npy; nothing if the name has none.
std::optional<std::uint32_t> frame_in(std::string_view path) {
    constexpr std::size_t least_digits = 6;
    path.remove_suffix(std::min(path.size(), std::string_view(".npy").size()));
    const std::size_t dot = path.rfind('.');
    if (dot == std::string_view::npos || path.size() - dot - 1 < least_digits) return std::nullopt;
    const std::string_view digits = path.substr(dot + 1);
    std::uint32_t frame = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), frame);
    if (error != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
    return frame;
}

/// Returns the text without the byte order mark of UTF-8, which some programs write first.
std::string_view without_mark(std::string_view text) {
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    return text;
}

/// Returns the end of the first line. In a table, a line break between quotes does not end the line.
std::size_t end_of_line(std::string_view text, bool table) {
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (table && text[i] == '"') quoted = !quoted;
        if (text[i] == '\n' && !quoted) return i;
    }
    return text.size();
}

/// The text of a result. Borrowed.
struct ResultText {
    std::string_view text;
    const std::string& file;
};

/// Calls use(line, place) for each line that is not blank. `table`: lines of CSV.
template <typename Use>
void for_each_line(const ResultText& result, bool table, const std::stop_token& stop, const Use& use) {
    std::string_view text = without_mark(result.text);
    for (std::uint64_t number = 1; !text.empty();) {
        throw_if_stopped(stop);
        const std::size_t end = end_of_line(text, table);
        std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        if (line.ends_with('\r')) line.remove_suffix(1);
        if (line.find_first_not_of(" \t") != std::string_view::npos)
            use(line, fmt::format("{}: line {}", result.file, number));
        number += 1 + std::uint64_t(std::count(line.begin(), line.end(), '\n'));
    }
}

void add_json_rows(const ResultText& text, ResultBuilder& builder, const std::stop_token& stop) {
    for_each_line(text, false, stop, [&](std::string_view line, const std::string& place) {
        const nlohmann::json value = parse_json(line, place, stop);
        const JsonFields fields(value, place);
        const CollisionRecord collision = read_collision(fields);
        if (collision.change == Change::gone) return;
        ResultRow row;
        if (fields.find("frame") != nullptr) {
            row.frame = fields.whole_number("frame");
            builder.set_moving();
        }
        if (fields.find("event") != nullptr) row.event = event_of(fields.text("event"), place);
        builder.add(std::move(row), collision, place);
    });
}

/// A line of a .csv file, whose header names the fields.
class CsvRow {
public:
    CsvRow(const std::vector<std::string>& header, std::string_view line, std::string place)
        : header_(header), fields_(csv_fields(line)), place_(std::move(place)) {
        if (fields_.size() != header.size()) {
            refuse(place_, fmt::format("{} fields; the header has {}", fields_.size(), header.size()));
        }
    }

    std::string_view text(std::string_view name) const {
        const auto at = std::find(header_.begin(), header_.end(), name);
        return at == header_.end() ? std::string_view() : std::string_view(fields_[std::size_t(at - header_.begin())]);
    }
    std::uint32_t whole_number(std::string_view name) const {
        const std::string_view field = text(name);
        std::uint32_t value = 0;
        const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
        if (error != std::errc() || end != field.data() + field.size()) {
            refuse(place_, fmt::format("{}: '{}' is not a whole number", name, shown_text(field)));
        }
        return value;
    }

private:
    const std::vector<std::string>& header_;
    std::vector<std::string> fields_;
    std::string place_;
};

void add_csv_rows(const ResultText& text, ResultBuilder& builder, const std::stop_token& stop) {
    std::vector<std::string> header;
    for_each_line(text, true, stop, [&](std::string_view line, const std::string& place) {
        if (header.empty()) {
            header = csv_fields(line);
            return;
        }
        const CsvRow fields(header, line, place);
        const CollisionRecord collision =
            read_csv_collision([&](std::string_view name) { return fields.text(name); }, place);
        if (collision.change == Change::gone) return;
        ResultRow row;
        if (std::find(header.begin(), header.end(), "frame") != header.end()) {
            row.frame = fields.whole_number("frame");
            builder.set_moving();
        }
        row.event = event_of(fields.text("event"), place);
        builder.add(std::move(row), collision, place);
    });
}

}  // namespace

bool is_result(const std::string& path) {
    const std::string ending = ending_of(path);
    if (ending == ".jsonl") return true;
    if (ending == ".csv") {
        const std::string head = read_text(InputFile(path), 4096, {});
        return is_result_header(without_mark(std::string_view(head).substr(0, head.find_first_of("\r\n"))));
    }
    if (ending != ".npy") return false;
    return holds_pairs(header_of(InputFile(path)));
}

ResultFile read_result(const std::string& path, const std::stop_token& stop) {
    const InputFile file(path);
    ResultBuilder builder(path);
    const std::string ending = ending_of(path);
    if (ending == ".npy") {
        const NpyHeader header = header_of(file);
        if (!holds_pairs(header)) refuse(path, "not an array of pairs");
        if (const auto frame = frame_in(path)) builder.set_first_frame(*frame);
        header.type == NpyType::uint32 ? add_npy_rows<std::uint32_t>(file, header, builder, stop)
                                       : add_npy_rows<std::uint64_t>(file, header, builder, stop);
        return builder.finish();
    }
    const std::string text = read_text(file, file.size(), stop);
    ending == ".jsonl" ? add_json_rows({text, path}, builder, stop) : add_csv_rows({text, path}, builder, stop);
    return builder.finish();
}

}  // namespace octopair::io
