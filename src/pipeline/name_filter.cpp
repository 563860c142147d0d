// Filter "name rules": removes pairs whose names match an exclusion rule.
//
// Each name is matched against each pattern once. Names that match the same patterns are of one kind. A kind has two ascending
// lists: rules whose first pattern its names match, and rules whose second pattern they match. A pair is removed if the
// first list of one kind and the second list of the other have a rule in common. Most kinds have empty lists.
#include <algorithm>
#include <map>
#include <utility>

#include "octopair/filters.hpp"
#include "pipeline/name_filter.hpp"
#include "pipeline/per_object.hpp"

namespace octopair {

namespace {

/// Returns the position behind the UTF-8 character at `at`.
std::size_t behind_character(std::string_view text, std::size_t at) {
    const auto is_continuation = [](char byte) { return (static_cast<unsigned char>(byte) & 0xC0) == 0x80; };
    const bool begins_several = (static_cast<unsigned char>(text[at]) & 0xC0) == 0xC0;
    ++at;
    while (begins_several && at < text.size() && is_continuation(text[at])) ++at;
    return at;
}

}  // namespace

bool matches_pattern(std::string_view name, std::string_view pattern) {
    constexpr auto none = std::string_view::npos;
    std::size_t n = 0, p = 0;
    std::size_t star = none, taken = 0;  // the last `*`, and the end of the text that it matches
    while (n < name.size()) {
        if (p < pattern.size() && pattern[p] == '*') {
            star = p++;
            taken = n;
        } else if (p < pattern.size() && pattern[p] == '?') {
            n = behind_character(name, n);
            ++p;
        } else if (p < pattern.size() && pattern[p] == name[n]) {
            ++n, ++p;
        } else if (star != none) {
            // No backtracking to earlier stars: the text between two stars was matched at its first occurrence.
            n = taken = behind_character(name, taken);
            p = star + 1;
        } else {
            return false;
        }
    }
    while (p < pattern.size() && pattern[p] == '*') ++p;
    return p == pattern.size();
}

namespace {

using RuleList = std::vector<std::uint32_t>;

/// The rules whose first pattern (`as_a`) and whose second pattern (`as_b`) a name matches.
struct Kind {
    RuleList as_a, as_b;
    auto operator<=>(const Kind&) const = default;
};

/// All kinds of names of a filter, shared by both sets.
class Kinds {
public:
    explicit Kinds(std::span<const NameRule> rules) {
        for (std::uint32_t i = 0; i < rules.size(); ++i) {
            patterns_[rules[i].a].as_a.push_back(i);
            patterns_[rules[i].b].as_b.push_back(i);
        }
    }

    /// Returns the number of the kind of each name.
    std::vector<std::uint32_t> of(std::span<const std::string> names) {
        std::vector<std::uint32_t> kinds;
        kinds.reserve(names.size());
        for (const std::string& name : names) kinds.push_back(of(name));
        return kinds;
    }

    const Kind& operator[](std::uint32_t kind) const { return *kinds_[kind]; }

private:
    std::uint32_t of(const std::string& name) {
        Kind kind;
        for (const auto& [pattern, rules] : patterns_) {
            if (name.empty() || !matches_pattern(name, pattern)) continue;
            kind.as_a.insert(kind.as_a.end(), rules.as_a.begin(), rules.as_a.end());
            kind.as_b.insert(kind.as_b.end(), rules.as_b.begin(), rules.as_b.end());
        }
        std::ranges::sort(kind.as_a);
        std::ranges::sort(kind.as_b);
        const auto [place, is_new] = numbers_.try_emplace(std::move(kind), std::uint32_t(kinds_.size()));
        if (is_new) kinds_.push_back(&place->first);
        return place->second;
    }

    std::map<std::string, Kind> patterns_;  // by pattern: the rules that have it
    std::map<Kind, std::uint32_t> numbers_;
    std::vector<const Kind*> kinds_;  // by number: keys of numbers_
};

bool have_common(const RuleList& first, const RuleList& second) {
    auto i = first.begin();
    auto j = second.begin();
    while (i != first.end() && j != second.end()) {
        if (*i == *j) return true;
        *i < *j ? ++i : ++j;
    }
    return false;
}

class NameFilter final : public Filter {
public:
    NameFilter(std::span<const std::string> names, std::span<const NameRule> rules,
               const std::optional<std::span<const std::string>>& second)
        : kinds_(rules), first_(kinds_.of(names)) {
        if (second) second_ = kinds_.of(*second);
        const std::span<const std::uint32_t> of_second = second_;
        of_objects_.emplace("name", first_, second ? std::optional(of_second) : std::nullopt);
    }

    std::string_view name() const override { return "name rules"; }
    void apply(Batch& batch) const override {
        batch.keep_if([&](std::size_t i) {
            const auto [a, b] = batch.pairs()[i];
            const Kind &kind_a = kinds_[of_objects_->first(a)], &kind_b = kinds_[of_objects_->second(b)];
            return !have_common(kind_a.as_a, kind_b.as_b) && !have_common(kind_a.as_b, kind_b.as_a);
        });
    }

private:
    Kinds kinds_;
    std::vector<std::uint32_t> first_, second_;
    std::optional<PerObject<std::uint32_t>> of_objects_;
};

}  // namespace

// NOLINTNEXTLINE(performance-unnecessary-value-param): the public function takes the rules by value.
std::unique_ptr<Filter> make_name_filter(std::span<const std::string> names, std::vector<NameRule> rules,
                                         std::optional<std::span<const std::string>> second) {
    return std::make_unique<NameFilter>(names, rules, second);
}

}  // namespace octopair
