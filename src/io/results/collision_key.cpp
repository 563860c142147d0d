#include "io/results/collision_key.hpp"

#include <utility>

#include <fmt/format.h>

#include "io/json/json_text.hpp"

namespace octopair::io {

namespace {

/// Returns the path of an object without the part that is the name of its file.
std::string_view path_in_file(std::string_view name, std::string_view root) {
    if (root.empty() || !name.starts_with(root)) return name;
    const std::string_view rest = name.substr(root.size());
    if (rest.empty()) return rest;
    return rest.front() == '/' ? rest.substr(1) : name;
}

/// Returns the key with a backslash before each bar and backslash, so that " | " ends it.
std::string escaped(std::string_view key) {
    std::string text;
    for (const char c : key) {
        if (c == '|' || c == '\\') text += '\\';
        text += c;
    }
    return text;
}

}  // namespace

std::string KeyMaker::different_from_known(const std::string& key) {
    std::string different = key;
    while (known_.contains(different)) different = fmt::format("{}~{}", key, ++known_[key]);
    known_.emplace(different, 1);
    return different;
}

std::vector<std::string> KeyMaker::keys_of(const ObjectNames& set) {
    std::vector<std::string> keys;
    keys.reserve(set.sources.empty() ? 0 : set.sources.back().end);
    std::uint32_t object = 0;
    for (const ObjectSource& source : set.sources) {
        ++inputs_;
        for (const std::uint32_t first = object; object < source.end; ++object) {
            const std::string_view name = object < set.names.size() ? set.names[object] : std::string_view();
            const std::string_view id =
                set.details == nullptr ? std::string_view() : set.details->of(object, Detail::id);
            std::string key;
            if (!id.empty() && !source.project.empty()) {
                key = fmt::format("{}/{}", source.project, id);
            } else if (!id.empty()) {
                key = fmt::format("{}/{}", inputs_, id);
            } else if (!name.empty()) {
                key = fmt::format("{}:{}", inputs_, path_in_file(name, source.root));
            } else {
                key = fmt::format("{}:#{}", inputs_, object - first);
            }
            keys.push_back(different_from_known(clean_text(key)));
        }
    }
    return keys;
}

std::string object_key(std::uint32_t object, const ObjectNames& names) {
    if (names.keys.empty()) return {};
    if (names.owners.empty()) return names.keys[object];
    return fmt::format("{}#{}", names.keys[names.owners[object]], names.triangle(object));
}

std::string collision_key(Pair pair, const CollisionNames& names) {
    std::string a = object_key(pair.a, names.a), b = object_key(pair.b, names.b);
    if (a.empty() || b.empty()) return {};
    if (b < a) std::swap(a, b);
    return fmt::format("{} | {}", escaped(a), escaped(b));
}

}  // namespace octopair::io
