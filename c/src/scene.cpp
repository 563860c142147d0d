// Scenes and their queries.
#include "octopair/scene.hpp"

#include <vector>

#include "call.hpp"

struct octopair_scene {
    octopair::Scene scene;
    std::int32_t precision;
};

/// Indices and values of all answers, with offsets.
struct octopair_answers {
    std::vector<std::uint64_t> offsets = {0};
    std::vector<std::uint32_t> indices;
    std::vector<double> values;
    bool has_values = false;
};

namespace octopair::c {

namespace {

static_assert(sizeof(octopair_id) == sizeof(ObjectId));

std::span<const ObjectId> ids_of(const octopair_id* ids, std::uint64_t count) {
    if (count > 0) required(ids, "ids");
    if (count > 0xFFFFFFFF)
        throw Error(ErrorCode::resource_limit, std::to_string(count) + " objects; at most 2^32 - 1 are possible");
    return {reinterpret_cast<const ObjectId*>(ids), std::size_t(count)};
}

std::vector<Traits> traits_of(const octopair_traits* traits, std::uint64_t count) {
    std::vector<Traits> rows;
    if (traits == nullptr) return rows;
    rows.reserve(std::size_t(count));
    for (std::uint64_t i = 0; i < count; ++i) rows.push_back({traits[i].groups, traits[i].mask, traits[i].fixed != 0});
    return rows;
}

template <typename Query>
std::span<const Query> queries_of(const double* numbers, std::uint64_t count) {
    if (count > 0) required(numbers, "queries");
    return {reinterpret_cast<const Query*>(numbers), std::size_t(count)};
}

void write_offsets(const std::vector<std::size_t>& ends, octopair_answers& out) {
    out.offsets.assign(1, 0);
    out.offsets.insert(out.offsets.end(), ends.begin(), ends.end());
}

void write(const Answers<std::uint32_t>& answers, octopair_answers& out) {
    write_offsets(answers.ends, out);
    out.indices = answers.all;
    out.has_values = false;
}

template <typename Answer>
void write(const Answers<Answer>& answers, double Answer::*value, octopair_answers& out) {
    write_offsets(answers.ends, out);
    out.indices.clear();
    out.values.clear();
    for (const Answer& answer : answers.all) {
        out.indices.push_back(answer.index);
        out.values.push_back(answer.*value);
    }
    out.has_values = true;
}

}  // namespace

}  // namespace octopair::c

using octopair::c::guarded;
using octopair::c::ids_of;
using octopair::c::queries_of;
using octopair::c::required;

octopair_status octopair_scene_create(const octopair_scene_options* options, octopair_scene** scene) {
    return guarded([&] {
        const auto values =
            octopair::c::read_struct(options, octopair_scene_options OCTOPAIR_SCENE_OPTIONS_INIT, "options");
        octopair_scene*& out = required(scene, "scene");
        octopair::c::boxes_of(values.precision, nullptr, 0);
        octopair::SceneOptions made;
        made.threads = values.threads;
        made.precision =
            values.precision == OCTOPAIR_FLOAT64 ? octopair::Precision::float64 : octopair::Precision::float32;
        made.margin = values.margin;
        made.slack = values.slack;
        if (values.recording != nullptr) made.recording = values.recording;
        out = new octopair_scene{octopair::Scene(made), values.precision};
    });
}
void octopair_scene_destroy(octopair_scene* scene) { delete scene; }

octopair_status octopair_scene_add(octopair_scene* scene, const octopair_objects* objects,
                                   const octopair_traits* traits, octopair_id* ids) {
    return guarded([&] {
        const octopair::Objects added = octopair::c::objects_of(objects, "objects");
        if (added.size() > 0) required(ids, "ids");
        const std::span<octopair::ObjectId> out(reinterpret_cast<octopair::ObjectId*>(ids), std::size_t(added.size()));
        required(scene, "scene").scene.add(added, out, octopair::c::traits_of(traits, added.size()));
    });
}

octopair_status octopair_scene_move(octopair_scene* scene, const octopair_id* ids, const void* boxes, uint64_t count) {
    return guarded([&] {
        octopair_scene& moved = required(scene, "scene");
        moved.scene.move(ids_of(ids, count), octopair::c::boxes_of(moved.precision, boxes, count));
    });
}

octopair_status octopair_scene_sweep(octopair_scene* scene, const octopair_id* ids, const void* boxes, uint64_t count) {
    return guarded([&] {
        octopair_scene& moved = required(scene, "scene");
        moved.scene.sweep(ids_of(ids, count), octopair::c::boxes_of(moved.precision, boxes, count));
    });
}

octopair_status octopair_scene_remove(octopair_scene* scene, const octopair_id* ids, uint64_t count) {
    return guarded([&] { required(scene, "scene").scene.remove(ids_of(ids, count)); });
}

octopair_status octopair_scene_set_traits(octopair_scene* scene, const octopair_id* ids, const octopair_traits* traits,
                                          uint64_t count) {
    return guarded([&] {
        if (count > 0) required(traits, "traits");
        const auto changed = ids_of(ids, count);
        required(scene, "scene").scene.set_traits(changed, octopair::c::traits_of(traits, count));
    });
}

uint64_t octopair_scene_count(const octopair_scene* scene) { return scene == nullptr ? 0 : scene->scene.size(); }

octopair_status octopair_scene_step(octopair_scene* scene, octopair_stop* stop, octopair_step* step) {
    return guarded([&] {
        required(step, "step");
        octopair::c::check_output(step, "step");
        const auto token = stop == nullptr ? std::stop_token() : stop->source.get_token();
        const octopair::StepResult& result = required(scene, "scene").scene.step(token);
        const auto pairs = [](std::span<const octopair::Pair> found) {
            return reinterpret_cast<const octopair_pair*>(found.data());
        };
        octopair::c::write_struct(
            step, octopair_step{sizeof(octopair_step), pairs(result.began), pairs(result.ended), result.began.size(),
                                result.ended.size(), result.persisting, result.seconds, result.full ? 1 : 0, 0});
    });
}

octopair_status octopair_scene_pairs(octopair_scene* scene, octopair_sink sink, void* data) {
    return guarded([&] {
        const octopair::PairSink receive = octopair::c::sink_of(sink, data);
        for (const auto chunk : required(scene, "scene").scene.pairs().chunks()) receive(chunk);
    });
}

octopair_status octopair_answers_create(octopair_answers** answers) {
    return guarded([&] {
        octopair_answers*& out = required(answers, "answers");
        out = new octopair_answers();
    });
}
void octopair_answers_destroy(octopair_answers* answers) { delete answers; }
uint64_t octopair_answers_queries(const octopair_answers* answers) {
    return answers == nullptr ? 0 : answers->offsets.size() - 1;
}
const uint64_t* octopair_answers_offsets(const octopair_answers* answers) {
    return answers == nullptr ? nullptr : answers->offsets.data();
}
const uint32_t* octopair_answers_indices(const octopair_answers* answers) {
    return answers == nullptr ? nullptr : answers->indices.data();
}
const double* octopair_answers_values(const octopair_answers* answers) {
    return answers == nullptr || !answers->has_values ? nullptr : answers->values.data();
}

octopair_status octopair_scene_overlap_boxes(octopair_scene* scene, const double* boxes, uint64_t count,
                                             uint32_t groups, octopair_answers* answers) {
    return guarded([&] {
        octopair::Answers<std::uint32_t> found;
        required(scene, "scene").scene.overlaps(queries_of<octopair::Box3d>(boxes, count), found, groups);
        octopair::c::write(found, required(answers, "answers"));
    });
}

octopair_status octopair_scene_overlap_balls(octopair_scene* scene, const double* balls, uint64_t count,
                                             uint32_t groups, octopair_answers* answers) {
    return guarded([&] {
        octopair::Answers<std::uint32_t> found;
        required(scene, "scene").scene.overlaps(queries_of<octopair::Sphere>(balls, count), found, groups);
        octopair::c::write(found, required(answers, "answers"));
    });
}

octopair_status octopair_scene_hits(octopair_scene* scene, const double* rays, uint64_t count, int all, uint32_t groups,
                                    octopair_answers* answers) {
    return guarded([&] {
        octopair::Answers<octopair::RayHit> found;
        octopair::Scene& searched = required(scene, "scene").scene;
        if (all != 0) {
            searched.all_hits(queries_of<octopair::Ray>(rays, count), found, groups);
        } else {
            searched.first_hits(queries_of<octopair::Ray>(rays, count), found, groups);
        }
        octopair::c::write(found, &octopair::RayHit::along, required(answers, "answers"));
    });
}

octopair_status octopair_scene_nearest(octopair_scene* scene, const double* places, uint64_t count, uint64_t k,
                                       double within, uint32_t groups, octopair_answers* answers) {
    return guarded([&] {
        octopair::Answers<octopair::Neighbor> found;
        const octopair::NearestLimits limits = {std::size_t(k), within};
        required(scene, "scene").scene.nearest(queries_of<octopair::Box3d>(places, count), limits, found, groups);
        octopair::c::write(found, &octopair::Neighbor::distance, required(answers, "answers"));
    });
}
