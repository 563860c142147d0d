#include "cli/output/found_writer.hpp"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "cli/detect/pipeline_options.hpp"
#include "io/files/atomic_file.hpp"
#include "io/formats/format_choice.hpp"
#include "io/results/bcf/bcf_writer.hpp"
#include "io/results/collision_key.hpp"
#include "io/results/collision_writer.hpp"
#include "io/results/pair_writer.hpp"

namespace octopair::cli {

namespace {

class Pairs final : public FoundWriter {
public:
    explicit Pairs(std::unique_ptr<io::PairWriter> writer) : writer_(std::move(writer)) {}

    void begin_frame(std::uint64_t frame) override { writer_->begin_frame(frame); }
    void write(std::span<const Pair> pairs, std::span<const Finding>) override { writer_->write(pairs); }
    void end_frame() override { writer_->end_frame(); }
    void finish(bool) override { writer_->finish(); }

private:
    std::unique_ptr<io::PairWriter> writer_;
};

/// Names, details, files and keys of the objects of a result. Borrows the sets.
class ResultNames {
public:
    ResultNames(const FoundIn& sets, bool join) : first_(sets.first) {
        std::vector<io::ObjectNames> all = {first_.names};
        if (join) all.push_back(second_.emplace(sets.second).names);
        keys_ = io::make_object_keys(all);
        first_.names.keys = &keys_.front();
        if (join) second_->names.keys = &keys_.back();
    }
    ResultNames(const ResultNames&) = delete;
    ResultNames& operator=(const ResultNames&) = delete;

    io::CollisionNames names() const { return {first_.names, second_ ? second_->names : first_.names}; }
    std::size_t files() const { return first_.names.sources.size() + (second_ ? second_->names.sources.size() : 0); }

private:
    struct Set {
        explicit Set(const InputSet& set) {
            const auto& triangles = set.scene.triangles;
            if (triangles) {
                names = {triangles->owner_names, triangles->owners, &triangles->owner_details};
            } else {
                names = {set.scene.names, {}, &set.scene.details};
            }
            std::uint64_t end = 0;
            for (const Part& part : set.parts) {
                end += part.objects;
                sources.push_back({part.path, end_of(end), part.project, part.root});
            }
            names.sources = sources;
        }
        /// Returns the end of the numbers of named objects, for the end of the numbers of objects.
        std::uint32_t end_of(std::uint64_t objects) const {
            if (names.owners.empty()) return std::uint32_t(objects);
            return objects == 0 ? 0 : names.owners[std::size_t(objects) - 1] + 1;
        }

        std::vector<io::ObjectSource> sources;
        io::ObjectNames names;
    };

    Set first_;
    std::optional<Set> second_;
    std::vector<io::ObjectKeys> keys_;
};

/// Writes collisions to several outputs at once. Collisions exist only for sets with shapes, which have no frames.
class Collisions final : public FoundWriter {
public:
    explicit Collisions(std::unique_ptr<ResultNames> names) : names_(std::move(names)) {}

    void set_baseline(io::Baseline baseline) { baseline_ = std::move(baseline); }
    void set_statuses(std::unique_ptr<io::Statuses> statuses) { statuses_ = std::move(statuses); }

    void add(std::unique_ptr<io::CollisionWriter> writer) { writers_.push_back(std::move(writer)); }
    /// Adds an .npy file, which gets only the pairs of the collisions.
    void add(std::unique_ptr<io::PairWriter> pairs) { pairs_ = std::move(pairs); }

    void begin_frame(std::uint64_t frame) override {
        if (pairs_) pairs_->begin_frame(frame);
    }
    void write(std::span<const Pair> pairs, std::span<const Finding> findings) override {
        std::vector<io::Change> changes;
        if (baseline_) changes = baseline_->compare(pairs, findings, names_->names());
        std::vector<io::RowStatus> statuses;
        if (statuses_) statuses = statuses_->take(pairs, findings, names_->names());
        for (const auto& writer : writers_) writer->write({pairs, findings, changes, statuses});
        if (pairs_) pairs_->write(pairs);
    }
    void end_frame() override {
        if (pairs_) pairs_->end_frame();
    }
    void leave_out(std::span<const Pair> pairs) override {
        if (statuses_) statuses_->leave_out(pairs, names_->names());
    }
    void finish(bool complete) override {
        if (baseline_) {
            const std::vector<std::string_view> gone = baseline_->gone();
            for (const auto& writer : writers_) writer->write_gone(gone);
        }
        for (const auto& writer : writers_) writer->finish();
        if (pairs_) pairs_->finish();
        if (statuses_) statuses_->write(complete);
    }
    std::optional<io::StatusCounts> statuses() const override {
        return statuses_ ? std::optional(statuses_->counts()) : std::nullopt;
    }
    std::optional<io::ChangeCounts> changes() const override {
        return baseline_ ? std::optional(baseline_->counts()) : std::nullopt;
    }

private:
    std::unique_ptr<ResultNames> names_;  // borrowed by the writers
    std::optional<io::Baseline> baseline_;
    std::unique_ptr<io::Statuses> statuses_;
    std::vector<std::unique_ptr<io::CollisionWriter>> writers_;
    std::unique_ptr<io::PairWriter> pairs_;
};

std::unique_ptr<io::PairWriter> make_pairs(const DetectRequest& request, const FoundIn& sets,
                                           const std::stop_token& stop) {
    const io::PairNames names{&sets.first.scene.names, &sets.second.scene.names};
    if (!request.output.empty()) return io::make_file_writer(request.output, sets.moving, names);
    return io::make_csv_writer(std::make_unique<io::StandardOutput>(stop), sets.moving);
}

std::unique_ptr<io::CollisionWriter> make_rows(const DetectRequest& request, const FoundIn& sets,
                                               const io::CollisionForm& form, const std::stop_token& stop) {
#ifdef OCTOPAIR_WITH_MESHES
    if (!request.output.empty() && io::result_format(request.output) == io::ResultFormat::bcf) {
        return io::make_bcf_writer(request.output, {form, sets.first.frame(0).boxes, sets.second.frame(0).boxes,
                                                    !request.against.empty(), space_of_result(request, sets)});
    }
#else
    (void)sets;
#endif
    if (!request.output.empty()) return io::make_collision_file_writer(request.output, form);
    return io::make_collision_csv_writer(std::make_unique<io::StandardOutput>(stop), form);
}

/// Returns the options that say what a collision is. Options that only leave out collisions are not among them: Statuses knows these
/// collisions (FoundWriter::leave_out()).
io::MeaningOptions meaning_of(const DetectRequest& request) {
    io::MeaningOptions options;
    if (!request.against.empty()) options.emplace_back("--against", "");
    if (request.mesh_objects == io::MeshObjects::triangle) options.emplace_back("--objects", "triangle");
    if (request.margin > 0) options.emplace_back("--margin", fmt::format("{}", request.margin));
    if (!request.padding.empty()) options.emplace_back("--padding", "");
    const std::optional<AdjacentTriangles> adjacent = request.pipeline.adjacent;
    if (adjacent == AdjacentTriangles::exclude) options.emplace_back("--adjacent", "exclude");
    if (adjacent == AdjacentTriangles::include) options.emplace_back("--adjacent", "include");
    if (request.pipeline.weld) options.emplace_back("--weld", fmt::format("{}", *request.pipeline.weld));
    return options;
}

std::unique_ptr<FoundWriter> make_collisions(const DetectRequest& request, const FoundIn& sets,
                                             const std::stop_token& stop) {
    const PipelineRequest& asked = request.pipeline;
    auto names = std::make_unique<ResultNames>(sets, !request.against.empty());
    io::CollisionForm form;
    form.names = names->names();
    form.files = names->files() > 1;
    form.features = stage_of(request) == Stage::features;
    form.times = sets.first.moves_meanwhile || sets.second.moves_meanwhile;
    form.changes = !asked.baseline.empty();
    form.statuses = !asked.statuses.empty();
    auto collisions = std::make_unique<Collisions>(std::move(names));
    if (form.changes) collisions->set_baseline(io::Baseline(asked.baseline, !request.against.empty(), stop));
    if (form.statuses)
        collisions->set_statuses(std::make_unique<io::Statuses>(asked.statuses, meaning_of(request), stop));
    if (io::is_array_file(request.output)) {
        collisions->add(make_pairs(request, sets, stop));
    } else {
        collisions->add(make_rows(request, sets, form, stop));
    }
#ifdef OCTOPAIR_WITH_PIPELINE
    if (!asked.report.empty()) collisions->add(make_report(request, sets));
#endif
    return collisions;
}

}  // namespace

std::unique_ptr<FoundWriter> make_found_writer(const DetectRequest& request, const FoundIn& sets,
                                               const std::stop_token& stop) {
    if (stage_of(request) == Stage::pairs) return std::make_unique<Pairs>(make_pairs(request, sets, stop));
    return make_collisions(request, sets, stop);
}

}  // namespace octopair::cli
