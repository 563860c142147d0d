// The filters of `octopair detect`: first those that leave out pairs by attributes of the objects (names, parents and groups), then the
// exact tests of shapes.
#include "cli/detect/filter_chain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "cli/detect/pipeline_options.hpp"
#include "cli/detect/relation_filter.hpp"
#include "cli/detect/row_filters.hpp"
#include "cli/input/shaped_set.hpp"
#include "io/files/failure.hpp"
#include "io/json/exclusion_rules.hpp"
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
    using AddFilter = std::function<void(std::unique_ptr<Filter>)>;

    Exclusions(AddFilter add, const DetectRequest& request, const SetPair& sets)
        : add_(std::move(add)), request_(request), sets_(sets) {}

    bool add(const io::ExclusionRules& rules) {
        if (stage_of(request_) != Stage::pairs) add_groups();
        if (request_.pipeline.same_parent.value_or(rules.same_parent)) add_parents();
        if (!rules.ignored_pairs.empty()) add_ignored(rules);
        if (!rules.exclude.empty()) add_rules(rules.exclude);
        if (!rules.relations.empty()) add_filter(make_relation_filter(rules.relations, sets_));
        return any_;
    }

private:
    bool join() const { return sets_.second != nullptr; }
    static Names names(const InputSet& set) { return set.scene.names; }

    // Adds the filter for groups and masks of scene files. Requires: the stage is not Stage::pairs, so all objects have shapes.
    void add_groups() {
        ShapedSet& first = *sets_.first.shaped;
        ShapedSet* const second = join() ? sets_.second->shaped.get() : nullptr;
        if (!first.has_groups() && (second == nullptr || !second->has_groups())) return;
        add_filter(make_group_filter(first.group_masks(),
                                     second != nullptr ? std::optional(second->group_masks()) : std::nullopt));
    }

    // Adds the filter of --same-parent exclude, which drops pairs of objects with the same parent. A join has none: its pairs are of objects
    // in different files, which have different parents.
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

    /// Throws: Error{usage, bad_input} if the patterns need names, or a detail such as the type, that no object has.
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
        add_(std::move(filter));
        any_ = true;
    }

    AddFilter add_;
    bool any_ = false;
    const DetectRequest& request_;
    const SetPair& sets_;
};

/// Returns the rules of --exclude: relations, or those of a file; without the option, returns no rules. Throws: Error{bad_input, io_failed}.
io::ExclusionRules read_exclusions(const DetectRequest& request) {
    const std::string& file = request.pipeline.exclude;
    if (file.empty()) return {};
    if (auto relations = io::relation_rules(file)) return std::move(*relations);
    return io::read_exclusion_rules(file);
}

/// Returns the classes of the rows: those of --classes; without the option, all except `undecided`.
ClassSet classes_of_rows(const DetectRequest& request) {
    const ClassSet all_but_undecided = ~ClassSet().set(std::size_t(CollisionClass::undecided));
    return request.pipeline.classes.value_or(all_but_undecided);
}

class RequestedFilters final : public FilterChain {
public:
    RequestedFilters(const DetectRequest& request, const SetPair& sets, const std::stop_token& stop)
        : sets_(sets),
          stop_(stop),
          margin_(request.margin),
          keeps_left_out_(!request.pipeline.statuses.empty()),
          pipeline_(local_threads(request.engine)),
          exclusions_(local_threads(request.engine)) {
        if (sets.first.scene.triangles) {
            add_triangles(request);
            return;
        }
        const io::ExclusionRules rules = read_exclusions(request);
        Exclusions([this](std::unique_ptr<Filter> filter) { add_option_filter(std::move(filter)); }, request, sets)
            .add(rules);
        if (request.verify) {
            const auto add = [this](std::unique_ptr<Filter> filter) { exclusions_.add(std::move(filter)); };
            has_exclusions_ = Exclusions(add, request, sets).add(rules);
        }
        warnings_ = relation_warnings(rules.relations, sets);
        if (stage_of(request) != Stage::pairs) add_exact(request);
    }

    const std::vector<std::string>& warnings() const override { return warnings_; }

    PipelineSummary run(Engine& engine, std::uint64_t frame, const CollisionSink& sink,
                        const Options& options) override {
        return pipeline_.run(engine, input_of(frame), sink, options, stop_);
    }

    PipelineSummary filter(const PairList& pairs, const CollisionSink& sink, const Options& options) override {
        return pipeline_.filter(pairs, sink, options, stop_);
    }

    std::vector<Pair> excluded(Engine& engine, std::uint64_t frame) override {
        std::vector<Pair> excluded;
        if (!has_exclusions_) return excluded;
        PairList all;
        engine.find_pairs(input_of(frame), all, {.margin = margin_}, stop_);
        // The filters keep the order of the pairs. So walk through `all` and the kept pairs together: pairs of `all` between two kept pairs
        // are excluded.
        auto chunk = all.chunks().begin();
        std::size_t next = 0;
        const auto exclude_up_to = [&](std::optional<Pair> kept) {
            for (; chunk != all.chunks().end(); ++chunk, next = 0) {
                for (; next < chunk->size(); ++next) {
                    const Pair pair = (*chunk)[next];
                    if (kept && pair == *kept) {
                        ++next;
                        return;
                    }
                    excluded.push_back(pair);
                }
            }
        };
        const CollisionSink keep = [&](const Batch& batch) {
            for (const Pair pair : batch.pairs()) exclude_up_to(pair);
        };
        exclusions_.filter(all, keep, {}, stop_);
        exclude_up_to({});
        return excluded;
    }

    std::span<const Pair> left_out() const override { return left_out_.pairs; }
    const LeftOut& left_out_by_class() const override { return left_out_by_class_; }

private:
    Input input_of(std::uint64_t frame) const {
        return {sets_.first.frame(frame),
                sets_.second != nullptr ? std::optional(sets_.second->frame(frame)) : std::nullopt};
    }

    void add_exact(const DetectRequest& request) {
        ExactOptions options{.margin = request.margin, .tolerance = tolerance_of(request, sets_)};
        options.duplicate_tolerance = request.pipeline.duplicate_tolerance;
        options.max_contacts = request.pipeline.max_contacts.value_or(options.max_contacts);
        const ClassSet classes = classes_of_rows(request);
        options.keep_undecided = classes.test(std::size_t(CollisionClass::undecided)) || keeps_left_out_;
        const ShapedObjects first = shaped(sets_.first);
        const auto second = sets_.second != nullptr ? std::optional(shaped(*sets_.second)) : std::nullopt;
        const ShapedObjects* const other = second ? &*second : nullptr;
        pipeline_.add(make_sphere_filter(first, request.margin, other));
        pipeline_.add(make_oriented_box_filter(first, request.margin, other));
        pipeline_.add(make_exact_object_filter(first, options, other));
        if (stage_of(request) == Stage::features) {
            if (request.pipeline.min_depth) add_early_depth(request, first, options, other);
            pipeline_.add(make_exact_feature_filter(first, options, other));
        }
        add_row_filters(request);
    }

    /// Adds a filter that applies --min-depth to the findings that the default tolerance gives, unless `options` have this tolerance.
    void add_early_depth(const DetectRequest& request, const ShapedObjects& first, const ExactOptions& options,
                         const ShapedObjects* other) {
        ExactOptions by_default{.margin = options.margin, .tolerance = default_tolerance_of(request, sets_)};
        by_default.max_contacts = 0;
        const double duplicate_tolerance = options.duplicate_tolerance.value_or(options.tolerance);
        if (options.tolerance == by_default.tolerance && duplicate_tolerance == by_default.tolerance) return;
        add_option_filter(
            make_early_depth_filter(make_exact_feature_filter(first, by_default, other), *request.pipeline.min_depth));
    }

    void add_row_filters(const DetectRequest& request) {
        const PipelineRequest& asked = request.pipeline;
        if (asked.min_depth) add_option_filter(make_depth_filter(*asked.min_depth));
        // With --statuses, the exact filters keep undecided pairs, so that this filter records those that are left out.
        if (!asked.classes && !keeps_left_out_) return;
        std::unique_ptr<Filter> classes = make_class_filter(classes_of_rows(request));
        if (request.verify) classes = make_recorded_filter(std::move(classes), left_out_by_class_);
        add_option_filter(std::move(classes));
    }

    /// Adds a filter that leaves out pairs because of an option. With --statuses, the pairs that it drops are recorded.
    void add_option_filter(std::unique_ptr<Filter> filter) {
        pipeline_.add(keeps_left_out_ ? make_recorded_filter(std::move(filter), left_out_) : std::move(filter));
    }

    void add_triangles(const DetectRequest& request) {
        TriangleOptions options{.margin = request.margin, .features = stage_of(request) == Stage::features};
        options.adjacent = request.pipeline.adjacent.value_or(options.adjacent);
        options.threads = local_threads(request.engine);
        options.tolerance = tolerance_of(request, sets_);
        const TriangleSet first = triangles(sets_.first);
        const auto second = sets_.second != nullptr ? std::optional(triangles(*sets_.second)) : std::nullopt;
        pipeline_.add(make_triangle_filter(first, options, second ? &*second : nullptr));
        add_row_filters(request);
    }

    static ShapedObjects shaped(const InputSet& set) { return set.shaped->objects(set.padding); }
    static TriangleSet triangles(const InputSet& set) {
        return {set.scene.triangles->triangles, set.scene.triangles->owners};
    }

    SetPair sets_;
    std::stop_token stop_;
    double margin_;
    bool keeps_left_out_;
    Pipeline pipeline_;
    Pipeline exclusions_;  // the exclusion rules alone, with --verify
    bool has_exclusions_ = false;
    std::vector<std::string> warnings_;
    LeftOut left_out_;                                   // by all filters that choose rows, with --statuses
    LeftOut left_out_by_class_{.keeps_findings = true};  // by --classes, with --verify
};

}  // namespace

std::unique_ptr<FilterChain> make_filter_chain(const DetectRequest& request, const SetPair& sets,
                                               const std::stop_token& stop) {
    return std::make_unique<RequestedFilters>(request, sets, stop);
}

}  // namespace octopair::cli
