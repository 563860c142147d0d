#include "cli/found_writer.hpp"

#include <utility>

#include "io/collision_writer.hpp"
#include "io/pair_writer.hpp"

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

/// Sets with shapes have no frames.
class Collisions final : public FoundWriter {
public:
    explicit Collisions(std::unique_ptr<io::CollisionWriter> writer) : writer_(std::move(writer)) {}

    void begin_frame(std::uint64_t) override {}
    void write(std::span<const Pair> pairs, std::span<const Finding> findings) override {
        writer_->write({pairs, findings});
    }
    void end_frame() override {}
    void finish() override { writer_->finish(); }

private:
    std::unique_ptr<io::CollisionWriter> writer_;
};

io::ObjectNames names_of(const InputSet& set) {
    if (set.scene.triangles) return {set.scene.triangles->owner_names, set.scene.triangles->owners};
    return {set.scene.names};
}

bool is_npy(const DetectRequest& request) {
    return !request.output.empty() && io::pair_format(request.output) == io::PairFormat::npy;
}

std::unique_ptr<io::PairWriter> make_pairs(const DetectRequest& request, const FoundIn& sets,
                                           const std::stop_token& stop) {
    const io::PairNames names{&sets.first.scene.names, &sets.second.scene.names};
    if (!request.output.empty()) return io::make_file_writer(request.output, sets.moving, names);
    return io::make_csv_writer(std::make_unique<io::StandardOutput>(stop), sets.moving);
}

std::unique_ptr<io::CollisionWriter> make_collisions(const DetectRequest& request, const FoundIn& sets,
                                                     const std::stop_token& stop) {
    io::CollisionForm form;
    form.names = {names_of(sets.first), names_of(sets.second)};
    form.features = stage_of(request) == Stage::features;
    form.times = sets.first.moves_meanwhile || sets.second.moves_meanwhile;
    if (!request.output.empty()) return io::make_collision_file_writer(request.output, form);
    return io::make_collision_csv_writer(std::make_unique<io::StandardOutput>(stop), form);
}

}  // namespace

std::unique_ptr<FoundWriter> make_found_writer(const DetectRequest& request, const FoundIn& sets,
                                               const std::stop_token& stop) {
    if (stage_of(request) == Stage::pairs || is_npy(request)) {
        return std::make_unique<Pairs>(make_pairs(request, sets, stop));
    }
    return std::make_unique<Collisions>(make_collisions(request, sets, stop));
}

}  // namespace octopair::cli
