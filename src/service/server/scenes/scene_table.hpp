// SceneTable: the running scenes of a server, by id.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "service/server/net/caller.hpp"

namespace octopair::service {

class ScenePublisher;

/// Thread safety: any thread may call it.
class SceneTable {
public:
    void enter(const std::shared_ptr<ScenePublisher>& scene);
    void remove(const ScenePublisher& scene);
    /// Throws: Error{bad_input} if the caller sees no scene `id`.
    std::shared_ptr<ScenePublisher> find(const Caller& caller, const std::string& id) const;
    /// Returns the scenes that the caller sees with ids greater than `after`, ascending by id, at most `most` of them.
    std::vector<std::shared_ptr<ScenePublisher>> of(const Caller& caller, const std::string& after,
                                                    std::size_t most) const;

private:
    mutable std::mutex mutex_;
    std::map<std::string, std::shared_ptr<ScenePublisher>> scenes_;
};

}  // namespace octopair::service
