// RemoteScene: a scene that lives on a server (`octopair serve`): calls and results are those of a Scene, and what goes over
// the network in a frame follows what moved.
//
// Result    the same ids, pairs and errors as of a Scene, byte for byte.
// Network   step() alone uses it: calls before it are checked and kept here, and go to the server with the step, which
//           returns what began and ended. A frame in which m objects moved sends about 32 m bytes (56 m in float64), and
//           receives 8 bytes a pair that began or ended.
// Faults    a server that goes away is waited for, as long as ClientOptions::patience, and given the whole scene again; ids
//           stay as they are. Then, or where the server refuses, step() throws: Error{resource_limit} that names the
//           server's limit, or Error{engine_failed}. Whatever it throws, the scene is as before the step, which may be
//           repeated: it then gives the server the whole scene again.
// Errors    otherwise as of a Scene; a scene that was moved from may only be destroyed or assigned to.
// Threads   one at a time.
// Memory    objects and pairs are also here: about 35 bytes an object (60 in float64), 16 a pair, and what is sent.
// Queries   are not offered: an overlap or a ray would wait for the network. A Scene that is given the same calls answers
//           them.
// Protocol  gRPC (docs/protocol.md). CMake: link octopair::client.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <string_view>

#include "octopair/client.hpp"
#include "octopair/scene.hpp"

namespace octopair {

/// As in SceneOptions.
struct RemoteSceneOptions {
    Precision precision = Precision::float32;
    double margin = 0;
};

class RemoteScene {
public:
    RemoteScene(RemoteScene&&) noexcept;
    RemoteScene& operator=(RemoteScene&&) noexcept;
    /// The server forgets the scene.
    ~RemoteScene();

    /// As of Scene; in all calls here arrays are copied.
    void add(const Objects& objects, std::span<ObjectId> ids, std::span<const Traits> traits = {});
    void move(std::span<const ObjectId> ids, const Boxes& boxes);
    void sweep(std::span<const ObjectId> ids, const Boxes& boxes);
    void remove(std::span<const ObjectId> ids);
    void set_traits(std::span<const ObjectId> ids, std::span<const Traits> traits);

    /// As of Scene; `seconds` includes the way to the server and back. Throws what is said above, and Error{cancelled} within
    /// 200 ms of a stop request.
    const StepResult& step(std::stop_token stop = {});

    /// As of Scene.
    const PairList& pairs();
    const PairList& persisting();

    std::uint64_t size() const;
    std::uint64_t indices() const;
    bool contains(ObjectId id) const;
    ObjectId id(std::uint32_t index) const;

private:
    class State;
    friend RemoteScene connect_scene(std::string_view, const RemoteSceneOptions&, const ClientOptions&);
    explicit RemoteScene(std::unique_ptr<State> state);

    std::unique_ptr<State> state_;
};

/// A new scene. Throws as connect(), and Error{bad_input} for a margin that is not finite or below 0.
RemoteScene connect_scene(std::string_view address, const RemoteSceneOptions& options = {},
                          const ClientOptions& client = {});

}  // namespace octopair
