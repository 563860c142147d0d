#include "io/json/exclusion_rules.hpp"

#include <span>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/files/failure.hpp"
#include "io/files/input_file.hpp"
#include "io/json/json_fields.hpp"

namespace octopair::io {

namespace {

using nlohmann::json;

std::string item(const std::string& place, std::size_t i) { return fmt::format("{}[{}]", place, i); }

NameRule rule(const json& value, const std::string& place) {
    const JsonFields fields(value, place);
    fields.allow({"a", "b"});
    return {fields.text("a"), fields.text("b")};
}

std::array<std::string, 2> name_pair(const json& value, const std::string& place) {
    const json::array_t& names = json_array(value, place);
    if (names.size() != 2) refuse(place, fmt::format("an array of {}, not of two names", names.size()));
    return {json_text(names[0], item(place, 0)), json_text(names[1], item(place, 1))};
}

/// Returns the results of `read` for the items of an array; empty if the object does not have the key.
template <typename Read>
auto each_of(const JsonFields& fields, std::string_view key, const Read& read) {
    const std::string place = fields.place_of(key);
    std::vector<decltype(read(json(), place))> all;
    if (const json* value = fields.find(key)) {
        const json::array_t& list = json_array(*value, place);
        for (std::size_t i = 0; i < list.size(); ++i) all.push_back(read(list[i], item(place, i)));
    }
    return all;
}

}  // namespace

ExclusionRules parse_exclusion_rules(std::string_view text, std::string_view file) {
    const json root = parse_json(text, file);
    const JsonFields fields(root, std::string(file));
    fields.allow({"exclude", "ignored_pairs", "same_parent"});
    ExclusionRules rules{each_of(fields, "exclude", rule), each_of(fields, "ignored_pairs", name_pair)};
    if (fields.find("same_parent") != nullptr) rules.same_parent = fields.boolean("same_parent");
    return rules;
}

ExclusionRules read_exclusion_rules(const std::string& path) {
    const InputFile file(path);
    constexpr std::uint64_t max_bytes = 1 << 30;
    if (file.size() > max_bytes) refuse(path, "the file is larger than 1 GiB, the maximum for exclusion rules");
    std::string text(std::size_t(file.size()), '\0');
    file.read(0, std::as_writable_bytes(std::span(text)));
    return parse_exclusion_rules(text, path);
}

}  // namespace octopair::io
