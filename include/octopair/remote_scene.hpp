// RemoteScene: a scene on a server (`octopair serve`). Calls and results are those of a Scene; the network traffic of a frame
// depends on what moved.
//
// Result    The same ids, pairs and errors as from a Scene, byte for byte.
// Network   Only step() uses the network. Other calls are checked and buffered here; step() sends them and receives the pairs
//           that began and ended. A frame with m moved objects sends about 32 m bytes (56 m in float64) and receives 8 bytes
//           per pair that began or ended.
// Faults    If the server becomes unreachable, step() waits for it, at most ClientOptions::patience, and then sends the whole
//           scene again. Ids do not change.
// Errors    If the server stays unreachable or refuses, step() throws Error{resource_limit} that names the server's limit, or
//           Error{engine_failed}. A step() that throws leaves the scene as it was and may be repeated; it then sends the whole
//           scene again. Other errors are those of a Scene. A scene that was moved from may only be destroyed or assigned to.
// Threads   One thread at a time.
// Memory    Objects and pairs are also stored here: about 35 bytes per object (60 in float64), 16 per pair, and the buffered
//           calls.
// Queries   Not offered: each query would wait for the network. A local Scene that receives the same calls can answer them.
// Protocol  gRPC (docs/protocol.md). CMake: link octopair::client.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <string_view>

#include "octopair/client.hpp"
#include "octopair/scene.hpp"

namespace [[gnu::visibility("default")]] octopair {

/// A part of SceneOptions (scene.hpp), with the same meaning.
struct RemoteSceneOptions {
    Precision precision = Precision::float32;
    double margin = 0;
};

class RemoteScene {
public:
    RemoteScene(RemoteScene&&) noexcept;
    RemoteScene& operator=(RemoteScene&&) noexcept;
    /// Deletes the scene on the server.
    ~RemoteScene();

    /// The calls from here to step() do what those of Scene (scene.hpp) do. All of them copy their arrays.
    void add(const Objects& objects, std::span<ObjectId> ids, std::span<const Traits> traits = {});
    void move(std::span<const ObjectId> ids, const Boxes& boxes);
    void sweep(std::span<const ObjectId> ids, const Boxes& boxes);
    void remove(std::span<const ObjectId> ids);
    void set_traits(std::span<const ObjectId> ids, std::span<const Traits> traits);

    /// Runs Scene::step() on the server. `StepResult::seconds` includes the network round trip.
    /// Throws: the errors listed at the head of this file; Error{cancelled} within 200 ms after a stop request.
    const StepResult& step(std::stop_token stop = {});

    /// The remaining calls do what those of Scene do.
    const PairList& pairs();
    const PairList& persisting();

    std::uint64_t size() const;
    std::uint64_t indices() const;
    bool contains(ObjectId id) const;
    ObjectId id(std::uint32_t index) const;

private:
    class [[gnu::visibility("hidden")]] State;
    friend RemoteScene connect_scene(std::string_view, const RemoteSceneOptions&, const ClientOptions&);
    explicit RemoteScene(std::unique_ptr<State> state);

    std::unique_ptr<State> state_;
};

/// Makes a new scene on the server at `address` and returns it.
/// Throws: as connect() (client.hpp); Error{bad_input} for a margin that is not finite or below 0.
RemoteScene connect_scene(std::string_view address, const RemoteSceneOptions& options = {},
                          const ClientOptions& client = {});

}  // namespace octopair
