// Octants of a scene. Indices that are not in use have boxes without meaning. If there are such indices, the boxes of the objects are
// first copied to consecutive positions. So the octants depend on the boxes of objects only.
#include <new>
#include <variant>
#include <vector>

#include "engine/threads/octant_lists.hpp"
#include "octopair/error.hpp"
#include "scene/scene_state.hpp"

namespace octopair {

namespace {

template <typename Element>
std::vector<Element> picked(std::span<const Element> all, std::span<const std::uint32_t> indices) {
    std::vector<Element> some;
    if (all.empty()) return some;
    some.reserve(indices.size());
    for (const std::uint32_t index : indices) some.push_back(all[index]);
    return some;
}

std::vector<std::uint32_t> indices_in_use(const ObjectTable& table) {
    std::vector<std::uint32_t> indices;
    indices.reserve(std::size_t(table.size()));
    for (std::uint32_t index = 0; index < table.indices(); ++index) {
        if (table.alive(index)) indices.push_back(index);
    }
    return indices;
}

}  // namespace

Octants Scene::State::octants(const std::stop_token& stop) {
    const ObjectTable& table = objects_.table();
    const Objects all = table.own_objects();
    if (table.size() == table.indices()) return copy_octants({all, margin_, table.indices()}, team_, stop);
    try {
        const std::vector<std::uint32_t> indices = indices_in_use(table);
        const std::vector<double> padding = picked(all.padding, indices);
        return std::visit(
            [&]<typename Real>(std::span<const Box<Real>> boxes) {
                const std::vector<Box<Real>> some = picked(boxes, indices);
                const Objects objects{std::span<const Box<Real>>(some), padding};
                return copy_octants({objects, margin_, table.indices(), indices}, team_, stop);
            },
            all.boxes);
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::resource_limit, "out of memory");
    }
}

}  // namespace octopair
