#include "octopair/scene.hpp"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "base/call_scope.hpp"
#include "base/floating_point_scope.hpp"
#include "octopair/error.hpp"
#include "scene/queries/query_rules.hpp"
#include "scene/scene_state.hpp"

namespace octopair {

namespace {

template <typename Query, typename IsOne>
void check_queries(std::span<const Query> queries, IsOne&& is_one) {
    const auto wrong = std::find_if_not(queries.begin(), queries.end(), is_one);
    if (wrong == queries.end()) return;
    const auto index = std::uint64_t(wrong - queries.begin());
    throw PlacedError(ErrorCode::bad_input, "query " + std::to_string(index) + " of the call is not valid",
                      {.index = index, .set = 0, .frame = {}});
}

/// Returns `*state`. Throws: Error{usage} if this thread is in a callback of the scene.
template <typename State>
State& outside_callbacks(const std::unique_ptr<State>& state) {
    if (!CallScope::is_inside(state.get())) return *state;
    throw Error(ErrorCode::usage,
                "a callback of the scene calls this scene, which is in the middle of a call: call it after the "
                "callback has returned");
}

}  // namespace

Scene::Scene(const SceneOptions& options) {
    const FloatingPointScope scope;
    state_ = std::make_unique<State>(options);
}
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;
Scene::~Scene() = default;

void Scene::add(const Objects& objects, std::span<ObjectId> ids, std::span<const Traits> traits) {
    const FloatingPointScope scope;
    outside_callbacks(state_).objects_to_change().add(objects, ids, traits);
}

void Scene::move(std::span<const ObjectId> ids, const Boxes& boxes) {
    const FloatingPointScope scope;
    outside_callbacks(state_).objects_to_change().move(ids, boxes, false);
}

void Scene::sweep(std::span<const ObjectId> ids, const Boxes& boxes) {
    const FloatingPointScope scope;
    outside_callbacks(state_).objects_to_change().move(ids, boxes, true);
}

void Scene::remove(std::span<const ObjectId> ids) {
    const FloatingPointScope scope;
    outside_callbacks(state_).objects_to_change().remove(ids);
}

void Scene::set_traits(std::span<const ObjectId> ids, std::span<const Traits> traits) {
    const FloatingPointScope scope;
    outside_callbacks(state_).objects_to_change().set_traits(ids, traits);
}

const StepResult& Scene::step(std::stop_token stop) {
    const FloatingPointScope scope;
    return outside_callbacks(state_).step(stop);
}

const PairList& Scene::pairs() {
    const FloatingPointScope scope;
    return outside_callbacks(state_).pairs();
}

const PairList& Scene::persisting() {
    const FloatingPointScope scope;
    return outside_callbacks(state_).persisting();
}

const PairList& Scene::enlarged_pairs() {
    const FloatingPointScope scope;
    return outside_callbacks(state_).searched_pairs();
}

void Scene::overlaps(std::span<const Box3d> boxes, Answers<std::uint32_t>& answers, std::uint32_t groups) {
    overlaps(boxes, answers, groups, {});
}

void Scene::overlaps(std::span<const Sphere> spheres, Answers<std::uint32_t>& answers, std::uint32_t groups) {
    overlaps(spheres, answers, groups, {});
}

void Scene::first_hits(std::span<const Ray> rays, Answers<RayHit>& answers, std::uint32_t groups) {
    first_hits(rays, answers, groups, {});
}

void Scene::all_hits(std::span<const Ray> rays, Answers<RayHit>& answers, std::uint32_t groups) {
    all_hits(rays, answers, groups, {});
}

void Scene::nearest(std::span<const Box3d> places, std::size_t count, Answers<Neighbor>& answers,
                    std::uint32_t groups) {
    nearest(places, NearestLimits{count}, answers, groups, {});
}

void Scene::nearest(std::span<const Box3d> places, const NearestLimits& limits, Answers<Neighbor>& answers,
                    std::uint32_t groups) {
    nearest(places, limits, answers, groups, {});
}

void Scene::overlaps(std::span<const Box3d> boxes, Answers<std::uint32_t>& answers, std::uint32_t groups,
                     std::stop_token stop) {
    const FloatingPointScope scope;
    check_queries(boxes, [](const Box3d& box) { return is_box(box); });
    outside_callbacks(state_).queries().overlaps(state_->view(groups, stop), boxes, answers);
}

void Scene::overlaps(std::span<const Sphere> spheres, Answers<std::uint32_t>& answers, std::uint32_t groups,
                     std::stop_token stop) {
    const FloatingPointScope scope;
    check_queries(spheres, is_sphere);
    outside_callbacks(state_).queries().overlaps(state_->view(groups, stop), spheres, answers);
}

void Scene::first_hits(std::span<const Ray> rays, Answers<RayHit>& answers, std::uint32_t groups,
                       std::stop_token stop) {
    const FloatingPointScope scope;
    check_queries(rays, is_ray);
    outside_callbacks(state_).queries().first_hits(state_->view(groups, stop), rays, answers);
}

void Scene::all_hits(std::span<const Ray> rays, Answers<RayHit>& answers, std::uint32_t groups, std::stop_token stop) {
    const FloatingPointScope scope;
    check_queries(rays, is_ray);
    outside_callbacks(state_).queries().all_hits(state_->view(groups, stop), rays, answers);
}

// NOLINTNEXTLINE(readability-function-size): the parameters of the other queries, and the limits.
void Scene::nearest(std::span<const Box3d> places, const NearestLimits& limits, Answers<Neighbor>& answers,
                    std::uint32_t groups, std::stop_token stop) {
    const FloatingPointScope scope;
    check_queries(places, [](const Box3d& box) { return is_box(box); });
    if (!(limits.within >= 0))
        throw Error(ErrorCode::bad_input, "NearestLimits::within must be a number of at least 0");
    outside_callbacks(state_).queries().nearest(state_->view(groups, stop), places, limits, answers);
}

std::vector<std::uint32_t> Scene::overlaps(const Box3d& box, std::uint32_t groups) {
    Answers<std::uint32_t> answers;
    overlaps(std::span(&box, 1), answers, groups);
    return std::move(answers.all);
}

std::vector<std::uint32_t> Scene::overlaps(const Sphere& sphere, std::uint32_t groups) {
    Answers<std::uint32_t> answers;
    overlaps(std::span(&sphere, 1), answers, groups);
    return std::move(answers.all);
}

std::optional<RayHit> Scene::first_hit(const Ray& ray, std::uint32_t groups) {
    Answers<RayHit> answers;
    first_hits(std::span(&ray, 1), answers, groups);
    return answers.all.empty() ? std::nullopt : std::optional(answers.all.front());
}

std::vector<RayHit> Scene::all_hits(const Ray& ray, std::uint32_t groups) {
    Answers<RayHit> answers;
    all_hits(std::span(&ray, 1), answers, groups);
    return std::move(answers.all);
}

std::vector<Neighbor> Scene::nearest(const Box3d& place, std::size_t count, std::uint32_t groups) {
    Answers<Neighbor> answers;
    nearest(std::span(&place, 1), count, answers, groups);
    return std::move(answers.all);
}

std::uint64_t Scene::size() const { return state_->objects().table().size(); }
std::uint64_t Scene::indices() const { return state_->objects().table().indices(); }
bool Scene::contains(ObjectId id) const { return state_->objects().table().contains(id); }

bool Scene::exists(std::uint32_t index) const noexcept {
    const ObjectTable& table = state_->objects().table();
    return index < table.indices() && table.alive(index);
}
Boxes Scene::boxes() const { return state_->objects().table().own_objects().boxes; }

Verification Scene::verify(std::stop_token stop) {
    const FloatingPointScope scope;
    return outside_callbacks(state_).verify(stop);
}

Octants Scene::octants(std::stop_token stop) const {
    const FloatingPointScope scope;
    return outside_callbacks(state_).octants(stop);
}

ObjectId Scene::id(std::uint32_t index) const { return state_->objects().id(index); }

}  // namespace octopair
