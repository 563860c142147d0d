// Filter "name rules": removes pairs whose names, or texts in several columns, match an exclusion rule.
//
// Each object is matched against each list of patterns once. Objects that match the same lists are of one kind. A kind has two
// ascending lists: rules whose first patterns its objects match, and rules whose second patterns they match. A pair is removed if the
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
    std::size_t star = none, taken = 0;  // position of the last `*`; end of the text that it matches so far
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

/// A kind of objects: the rules whose first patterns (`as_a`), and the rules whose second patterns (`as_b`), its objects match.
struct Kind {
    RuleList as_a, as_b;
    auto operator<=>(const Kind&) const = default;
};

/// All kinds of objects of a filter, shared by both sets.
class Kinds {
public:
    explicit Kinds(std::span<const ColumnRule> rules) {
        for (std::uint32_t i = 0; i < rules.size(); ++i) {
            patterns_[rules[i].a].as_a.push_back(i);
            patterns_[rules[i].b].as_b.push_back(i);
        }
    }

    /// Returns the number of the kind of each object.
    std::vector<std::uint32_t> of(const TextColumns& set) {
        std::vector<std::uint32_t> kinds;
        kinds.reserve(set.objects);
        for (std::size_t i = 0; i < set.objects; ++i) kinds.push_back(of(set, std::uint32_t(i)));
        return kinds;
    }

    const Kind& operator[](std::uint32_t kind) const { return *kinds_[kind]; }

private:
    static bool matches(const TextColumns& set, std::uint32_t object, const ColumnPatterns& patterns) {
        for (std::size_t column = 0; column < patterns.size(); ++column) {
            if (!patterns[column]) continue;
            const std::string_view text = set.text(object, column);
            if (text.empty() || !matches_pattern(text, *patterns[column])) return false;
        }
        return true;
    }

    std::uint32_t of(const TextColumns& set, std::uint32_t object) {
        Kind kind;
        for (const auto& [patterns, rules] : patterns_) {
            if (!matches(set, object, patterns)) continue;
            kind.as_a.insert(kind.as_a.end(), rules.as_a.begin(), rules.as_a.end());
            kind.as_b.insert(kind.as_b.end(), rules.as_b.begin(), rules.as_b.end());
        }
        std::ranges::sort(kind.as_a);
        std::ranges::sort(kind.as_b);
        const auto [place, is_new] = numbers_.try_emplace(std::move(kind), std::uint32_t(kinds_.size()));
        if (is_new) kinds_.push_back(&place->first);
        return place->second;
    }

    std::map<ColumnPatterns, Kind> patterns_;  // for each list of patterns, the rules that use it
    std::map<Kind, std::uint32_t> numbers_;
    std::vector<const Kind*> kinds_;  // kind of each number; points to the keys of numbers_
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

class ColumnFilter final : public Filter {
public:
    ColumnFilter(const TextColumns& first, std::span<const ColumnRule> rules, const TextColumns* second)
        : kinds_(rules), first_(kinds_.of(first)) {
        if (second != nullptr) second_ = kinds_.of(*second);
        const std::span<const std::uint32_t> of_second = second_;
        of_objects_.emplace("name", first_, second != nullptr ? std::optional(of_second) : std::nullopt);
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

/// Returns text columns whose only column is `names`.
TextColumns column_of(std::span<const std::string> names) {
    return {names.size(), [names](std::uint32_t object, std::size_t) { return std::string_view(names[object]); }};
}

}  // namespace

std::unique_ptr<Filter> make_column_filter(const TextColumns& first, const std::vector<ColumnRule>& rules,
                                           const TextColumns* second) {
    return std::make_unique<ColumnFilter>(first, rules, second);
}

// NOLINTNEXTLINE(performance-unnecessary-value-param): the public function takes the rules by value.
std::unique_ptr<Filter> make_name_filter(std::span<const std::string> names, std::vector<NameRule> rules,
                                         std::optional<std::span<const std::string>> second) {
    std::vector<ColumnRule> column_rules;
    column_rules.reserve(rules.size());
    for (const NameRule& rule : rules) column_rules.push_back({{rule.a}, {rule.b}});
    if (!second) return make_column_filter(column_of(names), column_rules);
    const TextColumns others = column_of(*second);
    return make_column_filter(column_of(names), column_rules, &others);
}

}  // namespace octopair
