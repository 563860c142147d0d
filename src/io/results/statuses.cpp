#include "io/results/statuses.hpp"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/files/failure.hpp"
#include "io/files/input_file.hpp"
#include "io/formats/format_choice.hpp"
#include "io/json/json_fields.hpp"
#include "io/json/json_text.hpp"
#include "io/results/collision_columns.hpp"
#include "io/results/collision_key.hpp"
#include "octopair/error.hpp"

namespace octopair::io {

namespace {

constexpr int max_levels = 16;  // of nested values in the file

/// Returns the content of a file; nothing if it does not exist.
std::optional<std::string> content_of(const std::string& path, const std::stop_token& stop) {
    std::error_code error;
    if (std::filesystem::symlink_status(path, error).type() == std::filesystem::file_type::not_found) return {};
    check_not_wrapped(path);
    const InputFile file(path);
    std::string text(std::size_t(file.size()), '\0');
    file.read(0, std::as_writable_bytes(std::span(text)), stop);
    return text;
}

/// Returns the text of the members of a JSON object whose keys are not in `known`: each begins with `before`.
std::string other_members(const nlohmann::json& object, std::initializer_list<std::string_view> known,
                          std::string_view before) {
    std::string text;
    for (const auto& [key, value] : object.items()) {
        if (std::find(known.begin(), known.end(), key) != known.end()) continue;
        text += fmt::format("{}{}: {}", before, json_string(key), dump_json(value));
    }
    return text;
}

std::string text_of(const MeaningOptions& options) {
    std::string text;
    for (const auto& [name, value] : options)
        text += fmt::format("{}{}{}{}", text.empty() ? "" : " ", name, value.empty() ? "" : " ", value);
    return text;
}

}  // namespace

Statuses::Statuses(const std::string& path, MeaningOptions options, const std::stop_token& stop)
    : path_(path), options_(std::move(options)), text_(content_of(path, stop)), file_(path) {
    if (text_) read(*text_);
}

void Statuses::read(std::string_view text) {
    const nlohmann::json root = parse_json(text, path_, {}, max_levels);
    const JsonFields fields(root, path_);
    if (fields.find("options") != nullptr) check_options(fields.text("options"));
    others_ = other_members(root, {"options", "collisions"}, ",\n");
    const auto& entries = json_array(fields.required("collisions"), fields.place_of("collisions"));
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const std::string place = fmt::format("{}: collisions[{}]", path_, i);
        const JsonFields entry(entries[i], place);
        Entry known;
        known.status = value_of_word<Status>(entry.text("status"), entry.place_of("status"));
        if (entry.find("comment") != nullptr) known.comment = entry.text("comment");
        if (entry.find("class") != nullptr) known.collision_class = entry.text("class");
        if (entry.find("a") != nullptr) known.objects[0] = entry.text("a");
        if (entry.find("b") != nullptr) known.objects[1] = entry.text("b");
        known.others = other_members(entries[i], {"key", "status", "comment", "class", "a", "b"}, ", ");
        if (!entries_.emplace(entry.text("key"), std::move(known)).second)
            entry.refuse_key("key", fmt::format("'{}' is twice in the file", shown_text(entry.text("key"))));
    }
}

void Statuses::check_options(std::string_view recorded) const {
    const std::string given = text_of(options_);
    if (recorded == given) return;
    const auto shown = [](std::string_view options) {
        return options.empty() ? "no option that matters" : std::string(options);
    };
    throw Error(ErrorCode::usage,
                fmt::format("{}: its statuses belong to a run with {}; this run has {}; use the "
                            "same options or another file, or remove \"options\" from the file to keep its statuses",
                            path_, shown(recorded), shown(given)));
}

std::vector<RowStatus> Statuses::take(std::span<const Pair> pairs, std::span<const Finding> findings,
                                      const CollisionNames& names) {
    std::vector<RowStatus> rows;
    rows.reserve(pairs.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const Pair pair = pairs[i];
        const CollisionClass now = findings.empty() ? CollisionClass::unknown : findings[i].collision_class;
        Entry& entry = entries_[collision_key(pair, names)];
        const bool was_apart = entry.collision_class == word_of(CollisionClass::clearance);
        if (entry.status == Status::resolved || (was_apart && meet(now))) entry.status = Status::begun;
        if (now != CollisionClass::unknown) entry.collision_class = word_of(now);
        entry.objects = {object_title(pair.a, names.a), object_title(pair.b, names.b)};
        if (object_key(pair.b, names.b) < object_key(pair.a, names.a)) std::swap(entry.objects[0], entry.objects[1]);
        entry.found = true;
        rows.push_back({entry.status, entry.comment});
    }
    return rows;
}

void Statuses::leave_out(std::span<const Pair> pairs, const CollisionNames& names) {
    if (entries_.empty()) return;
    for (const Pair pair : pairs) {
        const auto entry = entries_.find(collision_key(pair, names));
        if (entry != entries_.end()) entry->second.left_out = true;
    }
}

std::string Statuses::line_of(const std::string& key, const Entry& entry) {
    std::string line = fmt::format("{{\"key\": {}, \"status\": \"{}\", \"comment\": {}", json_string(key),
                                   word_of(entry.status), json_string(entry.comment));
    const auto add = [&](std::string_view name, const std::string& text) {
        if (!text.empty()) line += fmt::format(", \"{}\": {}", name, json_string(text));
    };
    add("class", entry.collision_class);
    add("a", entry.objects[0]);
    add("b", entry.objects[1]);
    return line + entry.others + '}';
}

void Statuses::write(bool complete) {
    if (content_of(path_, {}) != text_)
        refuse(path_, "was changed while octopair ran, and is left as it is; run octopair again");
    file_.write(fmt::format("{{\n\"options\": {},\n\"collisions\": [", json_string(text_of(options_))));
    std::string_view before = "\n";
    for (auto& [key, entry] : entries_) {
        if (complete && !entry.found && !entry.left_out) entry.status = Status::resolved;
        file_.write(fmt::format("{}{}", std::exchange(before, ",\n"), line_of(key, entry)));
    }
    file_.write(fmt::format("\n]{}\n}}\n", others_));
    file_.commit();
}

StatusCounts Statuses::counts() const {
    StatusCounts counts;
    for (const auto& [key, entry] : entries_) {
        if (entry.found) ++counts.found[std::size_t(entry.status)];
        if (!entry.found && entry.status == Status::resolved) ++counts.resolved;
    }
    return counts;
}

}  // namespace octopair::io
