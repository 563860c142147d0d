#include "service/server/scenes/scene_table.hpp"

#include "service/server/scenes/scene_publisher.hpp"

namespace octopair::service {

void SceneTable::enter(const std::shared_ptr<ScenePublisher>& scene) {
    const std::lock_guard lock(mutex_);
    scenes_.emplace(scene->id(), scene);
}

void SceneTable::remove(const ScenePublisher& scene) {
    const std::lock_guard lock(mutex_);
    scenes_.erase(scene.id());
}

std::shared_ptr<ScenePublisher> SceneTable::find(const Caller& caller, const std::string& id) const {
    const std::lock_guard lock(mutex_);
    const auto found = scenes_.find(id);
    if (found == scenes_.end() || !caller.sees(found->second->owner())) throw no_scene(id);
    return found->second;
}

std::vector<std::shared_ptr<ScenePublisher>> SceneTable::of(const Caller& caller, const std::string& after,
                                                            std::size_t most) const {
    const std::lock_guard lock(mutex_);
    std::vector<std::shared_ptr<ScenePublisher>> scenes;
    for (auto at = scenes_.upper_bound(after); at != scenes_.end() && scenes.size() < most; ++at) {
        if (caller.sees(at->second->owner())) scenes.push_back(at->second);
    }
    return scenes;
}

}  // namespace octopair::service
