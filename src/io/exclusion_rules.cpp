#include "io/exclusion_rules.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>
#include <span>

#include "io/failure.hpp"
#include "io/input_file.hpp"

namespace octopair::io {

namespace {

using Json = nlohmann::json;

/// The parser alone would keep the last of two equal keys.
class UniqueKeys {
public:
    explicit UniqueKeys(std::string_view file) : file_(file) {}

    bool operator()(int, Json::parse_event_t event, Json& value) {
        if (event == Json::parse_event_t::object_start) {
            seen_.emplace_back();
        } else if (event == Json::parse_event_t::object_end) {
            seen_.pop_back();
        } else if (event == Json::parse_event_t::key && !seen_.back().insert(value.get<std::string>()).second) {
            refuse(file_, fmt::format("the key {} is there twice", value.dump()));
        }
        return true;
    }

private:
    std::string_view file_;
    std::vector<std::set<std::string>> seen_;
};

/// What the parser says, without its own name and number before it.
std::string words_of(const Json::exception& error) {
    const std::string_view words = error.what();
    const std::size_t end = words.find("] ");
    return std::string(end == std::string_view::npos ? words : words.substr(end + 2));
}

class Reader {
public:
    explicit Reader(std::string_view file) : file_(file) {}

    ExclusionRules rules(const Json& root) const {
        ExclusionRules rules;
        if (!root.is_object()) refuse(file_, "not an object of JSON");
        for (const auto& [key, value] : root.items()) {
            if (key == "exclude") {
                const Json& list = array(value, key);
                for (std::size_t i = 0; i < list.size(); ++i) rules.exclude.push_back(rule(list[i], item(key, i)));
            } else if (key == "ignored_pairs") {
                const Json& list = array(value, key);
                for (std::size_t i = 0; i < list.size(); ++i)
                    rules.ignored_pairs.push_back(pair(list[i], item(key, i)));
            } else if (key == "same_parent") {
                if (!value.is_boolean()) refuse_value(key, "true or false", value);
                rules.same_parent = value.get<bool>();
            } else {
                refuse(file_,
                       fmt::format("{} is no key of exclusion rules; these are exclude, ignored_pairs, same_parent",
                                   quoted(key)));
            }
        }
        return rules;
    }

private:
    NameRule rule(const Json& value, const std::string& place) const {
        if (!value.is_object()) refuse_value(place, R"(an object {"a": PATTERN, "b": PATTERN})", value);
        for (const auto& [key, unused] : value.items()) {
            if (key != "a" && key != "b") refuse(file_, fmt::format("{}: {} is no key of a rule", place, quoted(key)));
        }
        const auto pattern = [&](const char* key) {
            if (!value.contains(key)) refuse(file_, fmt::format("{}: has no \"{}\"", place, key));
            return string(value[key], place + "." + key);
        };
        return {pattern("a"), pattern("b")};
    }

    std::array<std::string, 2> pair(const Json& value, const std::string& place) const {
        if (!value.is_array() || value.size() != 2) refuse_value(place, "an array of two names", value);
        return {string(value[0], item(place, 0)), string(value[1], item(place, 1))};
    }

    const Json& array(const Json& value, const std::string& place) const {
        if (!value.is_array()) refuse_value(place, "an array", value);
        return value;
    }

    std::string string(const Json& value, const std::string& place) const {
        if (!value.is_string()) refuse_value(place, "a string", value);
        return value.get<std::string>();
    }

    [[noreturn]] void refuse_value(const std::string& place, std::string_view wanted, const Json& value) const {
        refuse(file_, fmt::format("{}: {} is wanted, not {}", place, wanted, value.type_name()));
    }
    static std::string item(const std::string& place, std::size_t i) { return fmt::format("{}[{}]", place, i); }
    static std::string quoted(const std::string& key) { return Json(key).dump(); }

    std::string_view file_;
};

}  // namespace

ExclusionRules parse_exclusion_rules(std::string_view text, std::string_view file) {
    try {
        return Reader(file).rules(Json::parse(text, UniqueKeys(file)));
    } catch (const Json::exception& error) {  // of syntax, or of a number beyond float64
        refuse(file, words_of(error));
    }
}

ExclusionRules read_exclusion_rules(const std::string& path) {
    const InputFile file(path);
    constexpr std::uint64_t most = 1 << 30;
    if (file.size() > most) refuse(path, "longer than 1 GiB");
    std::string text(std::size_t(file.size()), '\0');
    file.read(0, std::as_writable_bytes(std::span(text)));
    return parse_exclusion_rules(text, path);
}

}  // namespace octopair::io
