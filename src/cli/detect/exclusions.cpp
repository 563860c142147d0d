#include "cli/detect/exclusions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "cli/input/shaped_set.hpp"
#include "io/files/failure.hpp"
#include "octopair/error.hpp"
#include "octopair/filters.hpp"

namespace octopair::cli {

namespace {

using Names = std::span<const std::string>;

/// Maps a name to the objects that have it. Several objects may have the same name.
class NameTable {
public:
    explicit NameTable(Names names) {
        for (std::uint32_t i = 0; i < names.size(); ++i) {
            if (!names[i].empty()) objects_[names[i]].push_back(i);
        }
    }
    std::span<const std::uint32_t> of(std::string_view name) const {
        const auto found = objects_.find(name);
        return found == objects_.end() ? std::span<const std::uint32_t>() : found->second;
    }

private:
    std::unordered_map<std::string_view, std::vector<std::uint32_t>> objects_;
};

class Exclusions {
public:
    Exclusions(Pipeline& pipeline, const DetectRequest& request, const SetPair& sets)
        : pipeline_(pipeline), request_(request), sets_(sets) {}

    bool add(const io::ExclusionRules& rules) {
        if (stage_of(request_) != Stage::pairs) add_groups();
        if (request_.pipeline.same_parent.value_or(rules.same_parent)) add_parents();
        if (!rules.ignored_pairs.empty()) add_ignored(rules);
        if (!rules.exclude.empty()) add_rules(rules.exclude);
        return any_;
    }

private:
    bool join() const { return sets_.second != nullptr; }
    static Names names(const InputSet& set) { return set.scene.names; }

    // Requires a stage beyond Stage::pairs: then all objects have shapes.
    void add_groups() {
        ShapedSet& first = *sets_.first.shaped;
        ShapedSet* const second = join() ? sets_.second->shaped.get() : nullptr;
        if (!first.has_groups() && (second == nullptr || !second->has_groups())) return;
        add_filter(make_group_filter(first.group_masks(),
                                     second != nullptr ? std::optional(second->group_masks()) : std::nullopt));
    }

    // In a join, the objects of a pair are in different files and cannot have the same parent.
    void add_parents() {
        if (!join() && sets_.first.shaped != nullptr) {
            add_filter(make_parent_filter(sets_.first.shaped->parents()));
        }
    }

    void add_ignored(const io::ExclusionRules& rules) {
        check_names();
        const NameTable first(names(sets_.first));
        const NameTable second(join() ? names(*sets_.second) : Names());
        std::vector<Pair> ignored;
        const auto ignore = [&](std::span<const std::uint32_t> all_a, std::span<const std::uint32_t> all_b) {
            for (const std::uint32_t a : all_a) {
                for (const std::uint32_t b : all_b) ignored.push_back({a, b});
            }
        };
        for (std::size_t i = 0; i < rules.ignored_pairs.size(); ++i) {
            const auto& [x, y] = rules.ignored_pairs[i];
            for (const std::string& name : {x, y}) {
                if (!first.of(name).empty() || !second.of(name).empty()) continue;
                io::refuse(request_.pipeline.exclude,
                           fmt::format("ignored_pairs[{}]: no object has the name '{}'", i, name));
            }
            ignore(first.of(x), join() ? second.of(y) : first.of(y));
            if (join()) ignore(first.of(y), second.of(x));
        }
        add_filter(make_ignored_pairs_filter(std::move(ignored), join()));
    }

    void add_rules(const std::vector<ColumnRule>& rules) {
        for (std::size_t i = 0; i < rules.size(); ++i) {
            check_columns(rules[i].a, fmt::format("exclude[{}]: a", i));
            check_columns(rules[i].b, fmt::format("exclude[{}]: b", i));
        }
        const TextColumns first = columns_of(sets_.first);
        const std::optional<TextColumns> second = join() ? std::optional(columns_of(*sets_.second)) : std::nullopt;
        add_filter(make_column_filter(first, rules, second ? &*second : nullptr));
    }

    static TextColumns columns_of(const InputSet& set) {
        return {std::size_t(set.scene.objects), [&scene = set.scene](std::uint32_t object, std::size_t column) {
                    if (column == 0) return object < scene.names.size() ? std::string_view(scene.names[object]) : "";
                    return scene.details.of(object, io::all_details[column - 1]);
                }};
    }

    /// Throws: Error{usage, bad_input} if no object has one of the details that the patterns need.
    void check_columns(const ColumnPatterns& patterns, const std::string& place) const {
        for (std::size_t column = 0; column < patterns.size(); ++column) {
            if (!patterns[column]) continue;
            if (column == 0) {
                check_names();
                continue;
            }
            const io::Detail detail = io::all_details[column - 1];
            if (sets_.first.scene.details.has(detail) || (join() && sets_.second->scene.details.has(detail))) continue;
            io::refuse(request_.pipeline.exclude,
                       fmt::format("{}: no object of the inputs has the detail '{}'", place, io::word_of(detail)));
        }
    }

    // A set whose files have no names has an empty list of names.
    void check_names() const {
        for (const InputSet* set : {&sets_.first, sets_.second}) {
            if (set == nullptr || set->scene.names.size() == set->scene.objects) continue;
            throw Error(ErrorCode::usage, fmt::format("--exclude: {} has objects without names", set->parts[0].path));
        }
    }

    void add_filter(std::unique_ptr<Filter> filter) {
        pipeline_.add(std::move(filter));
        any_ = true;
    }

    Pipeline& pipeline_;
    bool any_ = false;
    const DetectRequest& request_;
    const SetPair& sets_;
};

}  // namespace

io::ExclusionRules read_exclusions(const DetectRequest& request) {
    const std::string& file = request.pipeline.exclude;
    return file.empty() ? io::ExclusionRules() : io::read_exclusion_rules(file);
}

bool add_exclusions(Pipeline& pipeline, const io::ExclusionRules& rules, const DetectRequest& request,
                    const SetPair& sets) {
    return Exclusions(pipeline, request, sets).add(rules);
}

}  // namespace octopair::cli
