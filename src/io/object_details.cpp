#include "io/object_details.hpp"

#include <algorithm>

namespace octopair::io {

bool ObjectDetails::has(Detail detail) const {
    return std::any_of(rows.begin(), rows.end(), [detail](const auto& row) { return row[std::size_t(detail)] != 0; });
}

DetailsBuilder::DetailsBuilder(ObjectDetails& table) : table_(table) {
    for (std::uint32_t i = 0; i < table_.words.size(); ++i) numbers_.emplace(table_.words[i], i);
}

std::uint32_t DetailsBuilder::number_of(const std::string& word) {
    const auto [place, is_new] = numbers_.try_emplace(word, std::uint32_t(table_.words.size()));
    if (is_new) table_.words.push_back(word);
    return place->second;
}

void DetailsBuilder::add(const DetailTexts& texts) {
    auto& row = table_.rows.emplace_back();
    std::transform(texts.begin(), texts.end(), row.begin(),
                   [this](const std::string& text) { return number_of(text); });
}

void DetailsBuilder::append(const ObjectDetails& others, std::size_t count) {
    std::vector<std::uint32_t> renumbered;
    renumbered.reserve(others.words.size());
    for (const std::string& word : others.words) renumbered.push_back(number_of(word));
    const std::size_t before = table_.rows.size();
    for (auto row : others.rows) {
        for (std::uint32_t& word : row) word = renumbered[word];
        table_.rows.push_back(row);
    }
    table_.rows.resize(before + count);
}

std::string joined_materials(const std::set<std::string>& names) {
    constexpr std::size_t most = 8;
    std::string joined;
    std::size_t count = 0;
    for (const std::string& name : names) {
        if (++count > most) return joined + ", ...";
        joined += (joined.empty() ? "" : ", ") + name;
    }
    return joined;
}

void append_details(ObjectDetails& first, const ObjectDetails& second, const DetailCounts& counts) {
    if (first.empty() && second.empty()) return;
    first.rows.resize(counts.first);
    DetailsBuilder(first).append(second, counts.second);
}

}  // namespace octopair::io
