#include "cli/detect/filter_chain.hpp"

#include <optional>

#include "cli/detect/exclusions.hpp"
#include "cli/detect/tolerance.hpp"
#include "cli/input/shaped_set.hpp"
#include "octopair/filters.hpp"

namespace octopair::cli {

namespace {

class RequestedFilters final : public FilterChain {
public:
    RequestedFilters(const DetectRequest& request, const SetPair& sets, const std::stop_token& stop)
        : sets_(sets),
          stop_(stop),
          margin_(request.margin),
          pipeline_(local_threads(request.engine)),
          exclusions_(local_threads(request.engine)) {
        if (sets.first.scene.triangles) {
            add_triangles(request);
            return;
        }
        const io::ExclusionRules rules = read_exclusions(request);
        add_exclusions(pipeline_, rules, request, sets);
        if (request.verify) has_exclusions_ = add_exclusions(exclusions_, rules, request, sets);
        if (stage_of(request) != Stage::pairs) add_exact(request);
    }

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
        // The filters keep the order of the pairs. Those between two that they keep are excluded.
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

private:
    Input input_of(std::uint64_t frame) const {
        return {sets_.first.frame(frame),
                sets_.second != nullptr ? std::optional(sets_.second->frame(frame)) : std::nullopt};
    }

    void add_exact(const DetectRequest& request) {
        ExactOptions options{.margin = request.margin, .tolerance = tolerance_of(request, sets_)};
        options.duplicate_tolerance = request.pipeline.duplicate_tolerance;
        options.max_contacts = request.pipeline.max_contacts.value_or(options.max_contacts);
        const ShapedObjects first = shaped(sets_.first);
        const auto second = sets_.second != nullptr ? std::optional(shaped(*sets_.second)) : std::nullopt;
        const ShapedObjects* const other = second ? &*second : nullptr;
        pipeline_.add(make_sphere_filter(first, request.margin, other));
        pipeline_.add(make_oriented_box_filter(first, request.margin, other));
        pipeline_.add(make_exact_object_filter(first, options, other));
        if (stage_of(request) == Stage::features) pipeline_.add(make_exact_feature_filter(first, options, other));
        add_min_depth(request);
    }

    void add_min_depth(const DetectRequest& request) {
        if (request.pipeline.min_depth) pipeline_.add(make_depth_filter(*request.pipeline.min_depth));
    }

    void add_triangles(const DetectRequest& request) {
        TriangleOptions options{.margin = request.margin, .features = stage_of(request) == Stage::features};
        options.adjacent = request.pipeline.adjacent.value_or(options.adjacent);
        options.threads = local_threads(request.engine);
        options.tolerance = tolerance_of(request, sets_);
        const TriangleSet first = triangles(sets_.first);
        const auto second = sets_.second != nullptr ? std::optional(triangles(*sets_.second)) : std::nullopt;
        pipeline_.add(make_triangle_filter(first, options, second ? &*second : nullptr));
        add_min_depth(request);
    }

    static ShapedObjects shaped(const InputSet& set) { return set.shaped->objects(set.padding); }
    static TriangleSet triangles(const InputSet& set) {
        return {set.scene.triangles->triangles, set.scene.triangles->owners};
    }

    SetPair sets_;
    std::stop_token stop_;
    double margin_;
    Pipeline pipeline_;
    Pipeline exclusions_;  // the exclusion rules alone, with --verify
    bool has_exclusions_ = false;
};

}  // namespace

std::unique_ptr<FilterChain> make_filter_chain(const DetectRequest& request, const SetPair& sets,
                                               const std::stop_token& stop) {
    return std::make_unique<RequestedFilters>(request, sets, stop);
}

}  // namespace octopair::cli
