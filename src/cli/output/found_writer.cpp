#include "cli/output/found_writer.hpp"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "cli/detect/pipeline_options.hpp"
#include "io/files/atomic_file.hpp"
#include "io/formats/format_choice.hpp"
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
    void finish() override { writer_->finish(); }

private:
    std::unique_ptr<io::PairWriter> writer_;
};

/// Writes collisions to several outputs at once. Collisions exist only for sets with shapes, which have no frames.
class Collisions final : public FoundWriter {
public:
    Collisions(const io::CollisionNames& names, std::optional<io::Baseline> baseline)
        : names_(names), baseline_(std::move(baseline)) {}

    void add(std::unique_ptr<io::CollisionWriter> writer) { writers_.push_back(std::move(writer)); }
    /// Adds an .npy file, which gets only the pairs of the collisions.
    void add(std::unique_ptr<io::PairWriter> pairs) { pairs_ = std::move(pairs); }

    void begin_frame(std::uint64_t frame) override {
        if (pairs_) pairs_->begin_frame(frame);
    }
    void write(std::span<const Pair> pairs, std::span<const Finding> findings) override {
        std::vector<io::Change> changes;
        if (baseline_) changes = baseline_->compare(pairs, findings, names_);
        for (const auto& writer : writers_) writer->write({pairs, findings, changes});
        if (pairs_) pairs_->write(pairs);
    }
    void end_frame() override {
        if (pairs_) pairs_->end_frame();
    }
    void finish() override {
        if (baseline_) {
            const std::vector<std::string_view> gone = baseline_->gone();
            for (const auto& writer : writers_) writer->write_gone(gone);
        }
        for (const auto& writer : writers_) writer->finish();
        if (pairs_) pairs_->finish();
    }
    std::optional<io::ChangeCounts> changes() const override {
        return baseline_ ? std::optional(baseline_->counts()) : std::nullopt;
    }

private:
    io::CollisionNames names_;
    std::optional<io::Baseline> baseline_;
    std::vector<std::unique_ptr<io::CollisionWriter>> writers_;
    std::unique_ptr<io::PairWriter> pairs_;
};

io::ObjectNames names_of(const InputSet& set) {
    if (const auto& triangles = set.scene.triangles)
        return {triangles->owner_names, triangles->owners, &triangles->owner_details};
    return {set.scene.names, {}, &set.scene.details};
}

std::unique_ptr<io::PairWriter> make_pairs(const DetectRequest& request, const FoundIn& sets,
                                           const std::stop_token& stop) {
    const io::PairNames names{&sets.first.scene.names, &sets.second.scene.names};
    if (!request.output.empty()) return io::make_file_writer(request.output, sets.moving, names);
    return io::make_csv_writer(std::make_unique<io::StandardOutput>(stop), sets.moving);
}

std::unique_ptr<io::CollisionWriter> make_rows(const DetectRequest& request, const io::CollisionForm& form,
                                               const std::stop_token& stop) {
    if (!request.output.empty()) return io::make_collision_file_writer(request.output, form);
    return io::make_collision_csv_writer(std::make_unique<io::StandardOutput>(stop), form);
}

std::unique_ptr<FoundWriter> make_collisions(const DetectRequest& request, const FoundIn& sets,
                                             const std::stop_token& stop) {
    const PipelineRequest& asked = request.pipeline;
    io::CollisionForm form;
    form.names = {names_of(sets.first), names_of(sets.second)};
    form.features = stage_of(request) == Stage::features;
    form.times = sets.first.moves_meanwhile || sets.second.moves_meanwhile;
    form.changes = !asked.baseline.empty();
    std::optional<io::Baseline> baseline;
    if (form.changes) baseline.emplace(asked.baseline, !request.against.empty(), stop);
    auto collisions = std::make_unique<Collisions>(form.names, std::move(baseline));
    if (io::is_array_file(request.output)) {
        collisions->add(make_pairs(request, sets, stop));
    } else {
        collisions->add(make_rows(request, form, stop));
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
