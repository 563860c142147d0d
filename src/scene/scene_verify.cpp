// Scene::verify(): compares the pairs of the last step with those of a second algorithm (src/verification).
#include <utility>
#include <vector>

#include "octopair/error.hpp"
#include "scene/scene_state.hpp"
#include "verification/verifier.hpp"

namespace octopair {

namespace {

/// Returns a copy of `boxes` in which swept objects have the boxes of their sweeps.
template <typename Real>
std::vector<Box<Real>> with_swept_boxes(std::span<const Box<Real>> boxes,
                                        std::span<const SceneObjects::Settled> settled) {
    std::vector<Box<Real>> all(boxes.begin(), boxes.end());
    for (const SceneObjects::Settled& one : settled) {
        for (int axis = 0; axis < 3; ++axis) {
            all[one.index].min[axis] = Real(one.swept_box.min[axis]);
            all[one.index].max[axis] = Real(one.swept_box.max[axis]);
        }
    }
    return all;
}

}  // namespace

Verification Scene::State::verify(const std::stop_token& stop) {
    if (!states_.has_stepped() || objects_.is_changed_by_call())
        throw Error(ErrorCode::usage,
                    "verify: objects changed after the last step; call verify() directly after step()");
    try {
        const ObjectTable& table = objects_.table();
        Objects objects = table.own_objects();
        std::variant<std::vector<Box3f>, std::vector<Box3d>> swept;
        if (!objects_.settled().empty()) {
            std::visit([&](auto boxes) { swept = with_swept_boxes(boxes, objects_.settled()); }, objects.boxes);
            std::visit([&](const auto& boxes) { objects.boxes = std::span(boxes); }, swept);
        }
        // The rule of traits (Traits in octopair/scene.hpp), written again, so that the check shares no code with the scene.
        const auto allows = [&table](std::uint32_t a, std::uint32_t b) {
            if (!table.alive(a) || !table.alive(b)) return false;
            const Traits first = table.traits(a), second = table.traits(b);
            const bool may_meet = (first.groups & second.mask) != 0 && (second.groups & first.mask) != 0;
            return may_meet && !(first.fixed && second.fixed);
        };
        Verifier verifier({.objects = {objects, nullptr, margin_, allows}, .threads = team_.threads(), .stop = stop});
        const PairList& pairs = shown().list();
        for (const std::span<const Pair> chunk : pairs.chunks()) verifier.take(chunk);
        return verifier.finish({pairs.size(), false});
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::resource_limit, "out of memory");
    }
}

}  // namespace octopair
