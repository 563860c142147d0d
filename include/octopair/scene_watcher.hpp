// SceneWatcher: lists the scenes of a server (`octopair serve`), and copies their objects and pairs while their clients step them.
//
// Scenes    The scenes of RemoteScene objects, in any program. A scene is listed after its first call has reached the server, and until
//           its client ends. A client sees its own scenes. With the role reader it sees those of one owner. With the role operator
//           it lists the scenes of all owners, but next() throws Error{usage}, as reading a job's result does (docs/server.md).
// Steps     A watcher receives some of the steps. The server copies a scene at most once in 20 ms, and for at most 1% of the scene's
//           time, so it skips steps of large scenes. A scene waits for none of its watchers.
// Faults    If the server becomes unreachable, a call repeats its request until the server answers or ClientOptions::patience
//           has passed. Before the first contact, the call waits at most ClientOptions::connect_timeout. After a restart of the server
//           a scene has another id.
// Errors    octopair::Error, as from connect() (client.hpp). Error{bad_input} for a scene that the caller does not see, or that has
//           ended; Error{usage} if the server is too old; Error{resource_limit} that names the server's limit, above all if its
//           memory does not suffice for the copy; Error{cancelled} after a stop request.
// Threads   Several threads may use a watcher at once.
// Cost      next() receives 24 bytes per index of the scene (48 in float64), and 8 per listed pair. The server counts the copy as
//           memory of the scene's owner while it is sent.
// Protocol  gRPC (docs/protocol.md). CMake: link octopair::client.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "octopair/client.hpp"
#include "octopair/objects.hpp"
#include "octopair/scene.hpp"

namespace [[gnu::visibility("default")]] octopair {

/// A running scene of a server. Its counts are those after the last step.
struct SceneStatus {
    std::string id;     ///< UUID that the server chose
    std::string owner;  ///< name of the client that runs the scene; empty: this client
    Precision precision = Precision::float32;
    double margin = 0;
    std::uint64_t objects = 0;
    std::uint64_t pairs = 0;
    std::uint64_t steps = 0;  ///< number of steps so far
    double step_seconds = 0;  ///< duration of the last step on the server
};

/// State of a scene after a step.
struct SceneSnapshot {
    std::uint64_t step = 0;  ///< number of the step; the first step is 1
    /// Boxes by index, in the scene's precision. The box of an index without object has no meaning.
    std::variant<std::vector<Box3f>, std::vector<Box3d>> boxes;
    std::vector<bool> exists;  ///< by index: true if an object has the index; as many elements as `boxes`
    std::uint64_t pairs = 0;   ///< number of all pairs
    std::vector<Pair> listed;  ///< the first pairs, by indices, ascending
    std::uint64_t began = 0;   ///< number of pairs that began in the step
    std::uint64_t ended = 0;   ///< number of pairs that ended in the step
    double step_seconds = 0;   ///< duration of the step on the server
};

class SceneWatcher {
public:
    /// Takes the arguments of connect() (client.hpp). Does not connect yet. Throws: as connect(), except for an unreachable
    /// server.
    explicit SceneWatcher(std::string_view address, const ClientOptions& options = {});
    SceneWatcher(const SceneWatcher&) = delete;
    SceneWatcher& operator=(const SceneWatcher&) = delete;
    ~SceneWatcher();

    /// Returns the running scenes that the client sees, ascending by id.
    std::vector<SceneStatus> list(std::stop_token stop = {});
    /// Waits until the scene has a step after `after_step`, and returns the state after its last step; nothing if there is no such
    /// step within `most`. 0 as `after_step` accepts any step, also one of a scene that is idle. `listed` of the snapshot has the
    /// first `pair_limit` pairs, at most 1,000,000. The answer may take 0.1 s longer than `most`.
    std::optional<SceneSnapshot> next(const std::string& id, std::uint64_t after_step,
                                      std::chrono::duration<double> most, std::uint64_t pair_limit,
                                      std::stop_token stop = {});

private:
    class [[gnu::visibility("hidden")]] State;
    std::unique_ptr<State> state_;
};

}  // namespace octopair
