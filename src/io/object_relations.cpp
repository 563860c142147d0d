#include "io/object_relations.hpp"

#include <algorithm>

namespace octopair::io {

std::optional<Relation> relation_of(std::string_view word) {
    const auto* const found = std::find_if(all_relations.begin(), all_relations.end(),
                                           [&](Relation relation) { return word_of(relation) == word; });
    return found == all_relations.end() ? std::nullopt : std::optional(*found);
}

KeyNumbers::KeyNumbers(std::vector<std::string>& keys) : keys_(keys) {
    for (std::uint32_t i = 0; i < keys_.size(); ++i) numbers_.emplace(keys_[i], i);
}

std::uint32_t KeyNumbers::of(const std::string& key) {
    const auto [place, is_new] = numbers_.try_emplace(key, std::uint32_t(keys_.size()));
    if (is_new) keys_.push_back(key);
    return place->second;
}

void append_relations(ObjectRelations& first, const ObjectRelations& second, const DetailCounts& counts) {
    if (first.empty() && second.empty()) return;
    KeyNumbers numbers(first.keys);
    std::vector<std::uint32_t> renumbered;
    renumbered.reserve(second.keys.size());
    for (const std::string& key : second.keys) renumbered.push_back(numbers.of(key));
    for (std::size_t i = 0; i < second.links.size(); ++i) {
        for (const auto& [from, to] : second.links[i]) first.links[i].push_back({renumbered[from], renumbered[to]});
    }
    first.elements.resize(counts.first);
    for (const std::uint32_t element : second.elements) first.elements.push_back(renumbered[element]);
    first.elements.resize(counts.first + counts.second);
}

}  // namespace octopair::io
