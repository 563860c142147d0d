#include "scene/scene_box_source.hpp"

#include <algorithm>
#include <limits>

namespace octopair {

SceneBoxSource::SceneBoxSource(const ObjectTable& table, double margin)
    : table_(table), objects_(table.objects()), all_(objects_, nullptr, margin) {
    find_runs();
}

SceneBoxSource::SceneBoxSource(const ObjectTable& table, const EntryForm& form)
    : table_(table), objects_(table.objects()), all_(objects_, nullptr, form) {
    find_runs();
}

void SceneBoxSource::find_runs() {
    if (table_.size() == table_.indices()) {
        runs_.push_back({0, 0});
        return;
    }
    std::size_t position = 0;
    bool before = false;
    for (std::uint32_t index = 0; index < table_.indices(); ++index) {
        const bool alive = table_.alive(index);
        if (alive && !before) runs_.push_back({position, index});
        position += alive ? 1 : 0;
        before = alive;
    }
}

const SceneBoxSource::Run& SceneBoxSource::run_at(std::size_t position) const {
    return *(std::upper_bound(runs_.begin(), runs_.end(), position,
                              [](std::size_t at, const Run& run) { return at < run.position; }) -
             1);
}

std::size_t SceneBoxSource::index_at(std::size_t position) const {
    const Run& run = run_at(position);
    return run.index + (position - run.position);
}

bool SceneBoxSource::load(std::size_t begin, std::span<Entry> out) const {
    bool good = true;
    while (!out.empty()) {
        const Run* const run = &run_at(begin);
        const std::size_t end = run == &runs_.back() ? size() : run[1].position;
        const auto some = out.first(std::min(out.size(), end - begin));
        good = all_.load(run->index + (begin - run->position), some) && good;
        if (table_.any_traits()) {
            for (Entry& entry : some) entry.mask |= table_.traits(entry.object).fixed ? fixed_object : 0;
        }
        begin += some.size();
        out = out.subspan(some.size());
    }
    return good;
}

Float32Boxes SceneBoxSource::float32_boxes(std::size_t begin, std::span<Box3f> room) const {
    if (runs_.size() != 1 || table_.any_traits()) return {};
    return all_.float32_boxes(begin + runs_[0].index, room);
}

void SceneBoxSource::pick(std::span<const std::size_t> positions, std::span<Entry> out) const {
    std::vector<std::size_t> indices(positions.size());
    std::transform(positions.begin(), positions.end(), indices.begin(), [&](std::size_t at) { return index_at(at); });
    all_.pick(indices, out);
}

RoundingSlack SceneBoxSource::slack() const {
    if (!table_.any_traits()) return all_.slack();
    // An infinite slack makes every hit doubtful, so that is_pair() checks the traits of each hit.
    constexpr float all = std::numeric_limits<float>::infinity();
    return {{all, all, all}};
}

bool SceneBoxSource::is_pair(std::uint32_t a, std::uint32_t b) const {
    return compatible(table_.traits(a), table_.traits(b)) && all_.is_pair(a, b);
}

std::size_t SceneBoxSource::refused(const DoubtfulPairs& doubtful, std::uint32_t* out) const {
    return table_.any_traits() ? refused_one_by_one(doubtful, out) : all_.refused(doubtful, out);
}

}  // namespace octopair
