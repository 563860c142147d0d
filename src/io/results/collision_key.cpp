#include "io/results/collision_key.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "base/checksum.hpp"
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
std::string escaped(std::string key) {
    if (key.find_first_of("|\\") == std::string::npos) return key;
    std::string text;
    for (const char c : key) {
        if (c == '|' || c == '\\') text += '\\';
        text += c;
    }
    return text;
}

/// Returns the key of an object or an owner, as if no other object had this key.
std::string plain_key(std::uint32_t object, const ObjectNames& names, std::uint32_t inputs_before) {
    const auto source = std::upper_bound(names.sources.begin(), names.sources.end(), object,
                                         [](std::uint32_t n, const ObjectSource& one) { return n < one.end; });
    const auto input = inputs_before + 1 + std::uint32_t(source - names.sources.begin());
    const std::string_view name = object < names.names.size() ? names.names[object] : std::string_view();
    const std::string_view id = names.details == nullptr ? std::string_view() : names.details->of(object, Detail::id);
    if (!id.empty() && !source->project.empty()) return clean_text(fmt::format("{}/{}", source->project, id));
    if (!id.empty()) return clean_text(fmt::format("{}/{}", input, id));
    if (!name.empty()) return clean_text(fmt::format("{}:{}", input, path_in_file(name, source->root)));
    return fmt::format("{}#{}", input, object - (source == names.sources.begin() ? 0 : std::prev(source)->end));
}

/// Finds the keys that would occur twice. Keys are compared by a hash first, so that they need not be kept.
class RepeatSearch {
public:
    explicit RepeatSearch(std::span<const ObjectNames> sets) : sets_(sets), keys_(sets.size()) {
        for (std::uint32_t set = 0; set < sets.size(); ++set) {
            const auto inputs = std::uint32_t(sets[set].sources.size());
            if (set + 1 < sets.size()) keys_[set + 1].inputs_before = keys_[set].inputs_before + inputs;
            add_hashes(set);
        }
        std::sort(entries_.begin(), entries_.end());
    }

    std::vector<ObjectKeys> find() {
        for (auto first = entries_.begin(); first != entries_.end();) {
            const auto last =
                std::find_if(first, entries_.end(), [&](const Entry& entry) { return entry.hash != first->hash; });
            if (last - first > 1) number_equal_keys({first, last});
            first = last;
        }
        return std::move(keys_);
    }

private:
    struct Entry {
        std::uint64_t hash;
        std::uint32_t set, object;
        auto operator<=>(const Entry&) const = default;
    };

    static std::uint64_t hash_of(std::string_view key) {
        Checksum sum;
        sum.add(std::as_bytes(std::span(key)));
        return sum.value();
    }
    std::string key_of(const Entry& entry) const {
        return plain_key(entry.object, sets_[entry.set], keys_[entry.set].inputs_before);
    }
    void add_hashes(std::uint32_t set) {
        const ObjectNames& names = sets_[set];
        const std::uint32_t end = names.sources.empty() ? 0 : names.sources.back().end;
        for (std::uint32_t object = 0; object < end; ++object) {
            const bool named = object < names.names.size() && !names.names[object].empty();
            const bool has_id = names.details != nullptr && !names.details->of(object, Detail::id).empty();
            if (named || has_id) entries_.push_back({hash_of(key_of({0, set, object})), set, object});
        }
    }
    bool exists(std::string_view key) const {
        return std::ranges::binary_search(entries_, hash_of(key), {}, &Entry::hash);
    }
    /// Adds numbers to the keys of entries with one hash, in the order of the entries. Skips numbers that another object has in its key.
    void number_equal_keys(std::span<const Entry> entries) {
        std::unordered_map<std::string, std::uint32_t> last_number;
        for (const Entry& entry : entries) {
            const std::string key = key_of(entry);
            const auto [number, is_first] = last_number.try_emplace(key, 1);
            if (is_first) continue;
            std::string numbered = fmt::format("{}~{}", key, ++number->second);
            while (exists(numbered)) numbered = fmt::format("{}~{}", key, ++number->second);
            keys_[entry.set].repeated.emplace(entry.object, std::move(numbered));
        }
    }

    std::span<const ObjectNames> sets_;
    std::vector<ObjectKeys> keys_;
    std::vector<Entry> entries_;
};

}  // namespace

std::vector<ObjectKeys> make_object_keys(std::span<const ObjectNames> sets) { return RepeatSearch(sets).find(); }

std::string object_key(std::uint32_t object, const ObjectNames& names) {
    if (names.keys == nullptr) return {};
    const std::uint32_t named = names.owners.empty() ? object : names.owners[object];
    const auto repeated = names.keys->repeated.find(named);
    const std::string key =
        repeated == names.keys->repeated.end() ? plain_key(named, names, names.keys->inputs_before) : repeated->second;
    return names.owners.empty() ? key : fmt::format("{}#{}", key, names.triangle(object));
}

std::string collision_key(Pair pair, const CollisionNames& names) {
    std::string a = object_key(pair.a, names.a), b = object_key(pair.b, names.b);
    if (a.empty() || b.empty()) return {};
    if (b < a) std::swap(a, b);
    return escaped(std::move(a)) + " | " + escaped(std::move(b));
}

std::string object_title(std::uint32_t object, const ObjectNames& names) {
    const std::string_view label = names.detail(object, Detail::label), type = names.detail(object, Detail::type);
    if (!label.empty() && !type.empty() && label != type) return clean_text(fmt::format("{} ({})", label, type));
    if (!label.empty()) return clean_text(label);
    return names.of(object).empty() ? fmt::format("object {}", object) : clean_text(names.of(object));
}

}  // namespace octopair::io
