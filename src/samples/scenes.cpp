#include "samples/scenes.hpp"

#include <algorithm>
#include <limits>

#include "octopair/error.hpp"
#include "samples/kinds.hpp"
#include "samples/random.hpp"

namespace octopair::samples {

namespace {

constexpr std::uint64_t batch_objects = 8192;
constexpr std::uint64_t max_objects = std::numeric_limits<std::uint32_t>::max();

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::usage, message); }

const Kind& find_kind(std::string_view name) {
    const auto kinds = all_kinds();
    const auto found = std::find_if(kinds.begin(), kinds.end(), [&](const Kind& kind) { return kind.name == name; });
    if (found != kinds.end()) return *found;
    std::string message = "unknown kind of scene '" + std::string(name) + "'; the kinds are";
    for (const Kind& kind : kinds) message.append(" ").append(kind.name);
    refuse(message);
}

/// Calls `place(i)` for each object and passes the boxes to `sink` in batches.
template <typename Place>
void emit_frame(std::uint64_t objects, const Place& place, const SceneSink& sink) {
    std::vector<Box3f> batch;
    batch.reserve(std::min(objects, batch_objects));
    for (std::uint64_t i = 0; i < objects; ++i) {
        batch.push_back(place(i));
        if (batch.size() == batch_objects || i + 1 == objects) {
            sink(batch);
            batch.clear();
        }
    }
}

/// Cubes that move randomly in the unit cube, one step per frame.
class BrownianMotion {
public:
    explicit BrownianMotion(const SceneSpec& spec)
        : spec_(spec), side_(cube_side(spec.objects, 0.5)), positions_(3 * spec.objects) {
        for (std::uint64_t i = 0; i < spec.objects; ++i) {
            RandomStream random(spec.seed, i);
            for (std::uint64_t axis = 0; axis < 3; ++axis) positions_[3 * i + axis] = random.uniform();
        }
    }

    /// Moves every object by at most an eighth of its side on each axis. The low corners are reflected at the unit cube's
    /// faces.
    void step(std::uint64_t frame) {
        const std::uint64_t seed = mix_bits(spec_.seed) + frame;
        for (std::uint64_t i = 0; i < spec_.objects; ++i) {
            RandomStream random(seed, i);
            for (std::uint64_t axis = 0; axis < 3; ++axis) {
                double& x = positions_[3 * i + axis];
                x += side_ * random.uniform(-0.125, 0.125);
                if (x < 0) x = -x;
                if (x > 1) x = 2 - x;
            }
        }
    }

    Box3f box(std::uint64_t i) const {
        Box3f box;
        for (std::uint64_t axis = 0; axis < 3; ++axis) {
            box.min[axis] = float(positions_[3 * i + axis]);
            box.max[axis] = float(positions_[3 * i + axis] + side_);
        }
        return box;
    }

private:
    SceneSpec spec_;
    double side_;
    std::vector<double> positions_;  // low corners, x, y, z of each object
};

void emit_moving(const SceneSpec& spec, const SceneSink& sink) {
    BrownianMotion motion(spec);
    for (std::uint64_t frame = 0; frame < spec.frames; ++frame) {
        if (frame > 0) motion.step(frame);
        emit_frame(
            spec.objects, [&](std::uint64_t i) { return motion.box(i); }, sink);
    }
}

void check(const SceneSpec& spec, const Kind& kind) {
    if (spec.objects > max_objects) {
        refuse("a scene of " + std::to_string(spec.objects) + " objects; at most 4294967295 are possible");
    }
    if (spec.frames == 0) refuse("a scene has at least 1 frame");
    if (spec.frames > 1 && !kind.moves) {
        refuse("scenes of kind '" + spec.kind + "' do not move: 1 frame, not " + std::to_string(spec.frames));
    }
}

}  // namespace

std::vector<std::string_view> scene_kinds() {
    std::vector<std::string_view> names;
    for (const Kind& kind : all_kinds()) names.push_back(kind.name);
    return names;
}

std::string_view scene_description(std::string_view kind) { return find_kind(kind).description; }

void generate_scene(const SceneSpec& spec, const SceneSink& sink) {
    const Kind& kind = find_kind(spec.kind);
    check(spec, kind);
    if (spec.frames > 1) return emit_moving(spec, sink);
    emit_frame(spec.objects, kind.make_placer({spec.objects, spec.seed}), sink);
}

std::vector<Box3f> make_scene(std::string_view kind, std::uint64_t objects, std::uint64_t seed) {
    std::vector<Box3f> boxes;
    boxes.reserve(objects);
    generate_scene({std::string(kind), objects, seed},
                   [&](std::span<const Box3f> batch) { boxes.insert(boxes.end(), batch.begin(), batch.end()); });
    return boxes;
}

}  // namespace octopair::samples
