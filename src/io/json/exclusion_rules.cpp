#include "io/json/exclusion_rules.hpp"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <span>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "io/files/failure.hpp"
#include "io/files/input_file.hpp"
#include "io/formats/format_choice.hpp"
#include "io/json/json_fields.hpp"
#include "octopair/error.hpp"

namespace octopair::io {

namespace {

using nlohmann::json;

std::vector<std::string_view> relation_words() {
    std::vector<std::string_view> words;
    std::transform(all_relations.begin(), all_relations.end(), std::back_inserter(words),
                   [](Relation relation) { return word_of(relation); });
    return words;
}

std::string item(const std::string& place, std::size_t i) { return fmt::format("{}[{}]", place, i); }

/// Reads the patterns for one object of a pair: either a pattern for its name, or a JSON object with a pattern for each tested detail.
ColumnPatterns patterns(const JsonFields& rule, std::string_view key) {
    const json& value = rule.required(key);
    if (value.is_string()) return {rule.text(key)};
    if (!value.is_object()) refuse_json_type(rule.place_of(key), value, "a string or an object");
    const JsonFields fields(value, rule.place_of(key));
    ColumnPatterns found(1 + all_details.size());
    std::vector<std::string_view> keys = {"name"};
    for (const Detail detail : all_details) keys.push_back(word_of(detail));
    fields.allow(keys);
    bool any = false;
    for (std::size_t column = 0; column < keys.size(); ++column) {
        if (fields.find(keys[column]) == nullptr) continue;
        found[column] = fields.text(keys[column]);
        any = true;
    }
    if (!any) refuse(rule.place_of(key), fmt::format("needs at least one of the keys {}", fmt::join(keys, ", ")));
    return found;
}

/// A rule of the key "exclude".
using AnyRule = std::variant<ColumnRule, RelationRule>;

AnyRule rule(const json& value, const std::string& place) {
    const JsonFields fields(value, place);
    fields.allow({"a", "b", "relation"});
    if (fields.find("relation") == nullptr) return ColumnRule{patterns(fields, "a"), patterns(fields, "b")};
    fields.allow({"relation"});
    const std::string& word = fields.text("relation");
    const auto relation = relation_of(word);
    if (!relation) {
        refuse(fields.place_of("relation"), fmt::format("unknown relation '{}'; known relations: {}", shown_text(word),
                                                        fmt::join(relation_words(), ", ")));
    }
    return RelationRule{*relation, place};
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
    ExclusionRules rules;
    for (AnyRule& any : each_of(fields, "exclude", rule)) {
        if (auto* const by_text = std::get_if<ColumnRule>(&any)) {
            rules.exclude.push_back(std::move(*by_text));
        } else {
            rules.relations.push_back(std::move(std::get<RelationRule>(any)));
        }
    }
    rules.ignored_pairs = each_of(fields, "ignored_pairs", name_pair);
    if (fields.find("same_parent") != nullptr) rules.same_parent = fields.boolean("same_parent");
    return rules;
}

std::optional<ExclusionRules> relation_rules(std::string_view words) {
    ExclusionRules rules;
    for (std::string_view rest = words;;) {
        const std::size_t end = std::min(rest.find(','), rest.size());
        const auto relation = relation_of(rest.substr(0, end));
        if (!relation) return std::nullopt;
        rules.relations.push_back({*relation, "--exclude"});
        if (end == rest.size()) return rules;
        rest.remove_prefix(end + 1);
    }
}

void check_relations(std::string_view option, const std::string& value) {
    std::error_code error;
    const bool is_list = value.find(',') != std::string::npos || value.find_first_of("./") == std::string::npos;
    if (value.empty() || !is_list || std::filesystem::exists(value, error)) return;
    for (std::size_t begin = 0; begin <= value.size();) {
        const std::size_t end = std::min(value.find(',', begin), value.size());
        const std::string word = value.substr(begin, end - begin);
        begin = end + 1;
        if (relation_of(word)) continue;
        throw Error(ErrorCode::usage,
                    fmt::format("{}: '{}' is no relation, and there is no file '{}'; relations: {}", option,
                                shown_text(word), shown_text(value), fmt::join(relation_words(), ", ")));
    }
}

ExclusionRules read_exclusion_rules(const std::string& path) {
    check_not_wrapped(path);
    const InputFile file(path);
    constexpr std::uint64_t max_bytes = 1 << 30;
    if (file.size() > max_bytes) refuse(path, "the file is larger than 1 GiB, the maximum for exclusion rules");
    std::string text(std::size_t(file.size()), '\0');
    file.read(0, std::as_writable_bytes(std::span(text)));
    return parse_exclusion_rules(text, path);
}

}  // namespace octopair::io
