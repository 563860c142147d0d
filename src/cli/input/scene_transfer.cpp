// Sends a loaded scene as bytes from one process of this program to another on the same machine (isolated_read.hpp has the form).
#include <concepts>
#include <tuple>
#include <type_traits>

#include "cli/input/isolated_read.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

namespace {

/// Matches T and const T.
template <typename Any, typename T>
concept Some = std::same_as<std::remove_const_t<Any>, T>;

// The members of each class that is sent member by member. Sender and receiver use the same list.

auto members(Some<io::LoadedScene> auto& scene) {
    return std::tie(scene.boxes, scene.objects, scene.frames, scene.moving, scene.largest_rounded, scene.chord,
                    scene.names, scene.details, scene.relations, scene.project, scene.root, scene.space,
                    scene.converted_from, scene.warnings, scene.not_read, scene.elements, scene.shapes,
                    scene.triangles);
}
auto members(Some<io::ElementCounts> auto& elements) {
    return std::tie(elements.with_geometry, elements.read, elements.lost, elements.left_out);
}
auto members(Some<io::TypeCount> auto& type) { return std::tie(type.type, type.count); }
auto members(Some<io::LostElements> auto& lost) { return std::tie(lost.file, lost.type, lost.count, lost.first); }
auto members(Some<io::LoadedShapes> auto& loaded) {
    return std::tie(loaded.shapes, loaded.geometry, loaded.poses, loaded.parents, loaded.end_poses, loaded.padding,
                    loaded.groups, loaded.masks);
}
auto members(Some<io::LoadedTriangles> auto& loaded) {
    return std::tie(loaded.triangles, loaded.owners, loaded.owner_names, loaded.owner_details);
}
auto members(Some<io::ObjectDetails> auto& details) { return std::tie(details.words, details.rows); }
auto members(Some<io::ObjectRelations> auto& relations) {
    return std::tie(relations.keys, relations.elements, relations.links[0], relations.links[1], relations.links[2]);
}
auto members(Some<io::SceneSpace> auto& space) { return std::tie(space.up, space.unit); }
auto members(Some<shape::ConvexHull> auto& hull) { return std::tie(hull.points); }
auto members(Some<shape::Mesh> auto& mesh) { return std::tie(mesh.vertices, mesh.triangles); }

class SceneSender {
public:
    explicit SceneSender(const PutBytes& put) : put_(put) {}

    template <typename T>
    void pass(const T& value) {
        if constexpr (std::is_trivially_copyable_v<T>) {
            put_(std::as_bytes(std::span(&value, 1)));
        } else if constexpr (requires { members(value); }) {
            std::apply([&](const auto&... parts) { (pass(parts), ...); }, members(value));
        } else {
            pass_container(value);
        }
    }

private:
    template <typename T>
    void pass_container(const Buffer<T>& buffer) {
        pass(std::uint64_t(buffer.size()));
        put_(std::as_bytes(buffer.span()));
    }
    void pass_container(const std::string& text) {
        pass(std::uint64_t(text.size()));
        put_(std::as_bytes(std::span(text)));
    }
    template <typename T>
    void pass_container(const std::vector<T>& values) {
        pass(std::uint64_t(values.size()));
        if constexpr (std::is_trivially_copyable_v<T>) {
            put_(std::as_bytes(std::span(values)));
        } else {
            for (const T& value : values) pass(value);
        }
    }
    template <typename T>
    void pass_container(const std::optional<T>& value) {
        pass(value.has_value());
        if (value) pass(*value);
    }
    template <typename... T>
    void pass_container(const std::variant<T...>& value) {
        pass(std::uint64_t(value.index()));
        std::visit([&](const auto& held) { pass(held); }, value);
    }

    const PutBytes& put_;
};

class SceneReceiver {
public:
    explicit SceneReceiver(const GetBytes& get) : get_(get) {}

    template <typename T>
    void pass(T& value) {
        if constexpr (std::is_trivially_copyable_v<T>) {
            get_(std::as_writable_bytes(std::span(&value, 1)));
        } else if constexpr (requires { members(value); }) {
            std::apply([&](auto&... parts) { (pass(parts), ...); }, members(value));
        } else {
            pass_container(value);
        }
    }

private:
    std::size_t size() {
        std::uint64_t size = 0;
        pass(size);
        return std::size_t(size);
    }

    template <typename T>
    void pass_container(Buffer<T>& buffer) {
        buffer.resize_discard(size());
        get_(std::as_writable_bytes(buffer.span()));
    }
    void pass_container(std::string& text) {
        text.resize(size());
        get_(std::as_writable_bytes(std::span(text)));
    }
    template <typename T>
    void pass_container(std::vector<T>& values) {
        values.resize(size());
        if constexpr (std::is_trivially_copyable_v<T>) {
            get_(std::as_writable_bytes(std::span(values)));
        } else {
            for (T& value : values) pass(value);
        }
    }
    template <typename T>
    void pass_container(std::optional<T>& value) {
        bool there = false;
        pass(there);
        if (there) pass(value.emplace());
    }
    template <typename... T>
    void pass_container(std::variant<T...>& value) {
        const std::size_t index = size();
        std::size_t i = 0;
        ((i++ == index ? pass(value.template emplace<T>()) : void()), ...);
        if (index >= i)
            throw Error(ErrorCode::engine_failed, "received invalid data instead of a scene from another process");
    }

    const GetBytes& get_;
};

}  // namespace

void send_scene(const io::LoadedScene& scene, const PutBytes& put) { SceneSender(put).pass(scene); }

io::LoadedScene receive_scene(const GetBytes& get) {
    io::LoadedScene scene;
    SceneReceiver(get).pass(scene);
    return scene;
}

}  // namespace octopair::cli
