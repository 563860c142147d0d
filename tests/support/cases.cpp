#include "support/cases.hpp"

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "samples/random.hpp"
#include "support/kinds.hpp"
#include "support/scale.hpp"

namespace octopair::test {

namespace {

using samples::RandomStream;

std::uint64_t object_count(const std::string& kind, RandomStream& random) {
    const bool many_pairs = kind == "coincident" || kind == "giants" || kind == "duplicates" || kind == "signed-zeros";
    const auto size = random.below(100);
    std::uint64_t bound = size < 60 ? 64 : size < 96 ? 400 : 3001;
    if (many_pairs && size < 99) bound = std::min<std::uint64_t>(bound, 400);
    return random.below(bound);
}

/// Returns the largest extent of about 16 sampled boxes, where the extent of a box is its shortest side. A margin or padding of
/// this length adds pairs, but does not make all objects pairs.
double usual_extent(const OwnedObjects& objects) {
    double extent = 0;
    const auto measure = [&](const auto& boxes) {
        for (std::size_t i = 0; i < boxes.size(); i += 1 + boxes.size() / 16) {
            double smallest = double(boxes[i].max[0]) - double(boxes[i].min[0]);
            for (int axis = 1; axis < 3; ++axis) {
                smallest = std::min(smallest, double(boxes[i].max[axis]) - double(boxes[i].min[axis]));
            }
            extent = std::max(extent, smallest);
        }
    };
    std::visit(measure, objects.boxes);
    return std::min(extent, 1e300);
}

double clearance(double extent, RandomStream& random) {
    switch (random.below(4)) {
        case 0:
            return 0;
        case 1:
            return extent;
        case 2:
            return extent * random.uniform();
        default:
            return double(random.below(3)) / 2;  // on a lattice, exactly the distance of a neighbour
    }
}

void add_padding(OwnedObjects& objects, RandomStream& random) {
    const double extent = usual_extent(objects) / 2;
    const std::uint64_t count = objects.view().size();
    for (std::uint64_t i = 0; i < count; ++i) objects.padding.push_back(clearance(extent, random));
}

OwnedObjects make_objects(const std::string& kind, std::uint64_t seed) {
    RandomStream random(seed, 1);
    const std::uint64_t count = object_count(kind, random);
    OwnedObjects objects;
    if (random.below(2) == 0) {
        objects.boxes = make_boxes(kind, count, seed);
    } else {
        objects.boxes = make_double_boxes(kind, count, seed);
    }
    if (random.below(4) == 0) add_padding(objects, random);
    return objects;
}

}  // namespace

Objects OwnedObjects::view() const {
    Objects objects;
    std::visit([&](const auto& owned) { objects.boxes = std::span(owned); }, boxes);
    objects.padding = padding;
    return objects;
}

Input Case::input() const { return {first.view(), second ? std::optional(second->view()) : std::nullopt}; }

std::string Case::describe() const {
    std::ostringstream text;
    const auto write = [&](const OwnedObjects& objects) {
        text << objects.view().size() << (objects.boxes.index() == 0 ? " float32" : " float64") << " boxes"
             << (objects.padding.empty() ? "" : " with padding");
    };
    write(first);
    if (second) {
        text << " against ";
        write(*second);
    }
    text << ", margin " << margin << ", limit " << limit << ", buffer " << buffer_bytes << ", threads " << threads[0]
         << " " << threads[1] << " " << threads[2];
    return text.str();
}

Case make_case(const std::string& kind, std::uint64_t seed) {
    RandomStream random(seed, 0);
    Case result;
    result.first = make_objects(kind, seed);
    if (random.below(3) == 0) result.second = make_objects(kind, seed + 1);
    if (random.below(3) == 0) result.margin = clearance(usual_extent(result.first), random);
    result.limit = random.below(3) == 0 ? random.below(100000) : random.below(1 + result.first.view().size());
    result.buffer_bytes = random.below(2) == 0 ? 0 : std::uint64_t(1) << random.below(26);
    for (unsigned& threads : result.threads) threads = 1 + unsigned(random.below(8));
    return result;
}

std::uint64_t case_count(std::uint64_t usual) {
    if (std::getenv("OCTOPAIR_TEST_SEED") != nullptr) return 1;
    const char* asked = std::getenv("OCTOPAIR_TEST_CASES");
    if (asked != nullptr) return std::strtoull(asked, nullptr, 10);
    const char* share = std::getenv("OCTOPAIR_TEST_SHARE");
    if (share == nullptr) return usual;
    return std::max<std::uint64_t>(1, usual * std::strtoull(share, nullptr, 10) / 100);
}

SceneRange SceneRange::part(std::uint64_t i, std::uint64_t parts) const {
    return {begin + size() * i / parts, begin + size() * (i + 1) / parts};
}

SceneRange scene_range(SceneSize size, std::uint64_t usual) {
    if (std::getenv("OCTOPAIR_TEST_SEED") != nullptr) {
        const std::uint64_t seed = case_seed({}, 0);
        return {seed, seed + 1};
    }
    const bool small = size == SceneSize::small;
    const char* asked = std::getenv(small ? "OCTOPAIR_TEST_SMALL_SCENES" : "OCTOPAIR_TEST_LARGE_SCENES");
    if (asked == nullptr) return {0, usual};
    return {0, scaled(std::strtoull(asked, nullptr, 10), small ? 20 : 10)};
}

std::uint64_t case_seed(const std::string& kind, std::uint64_t i) {
    if (const char* seed = std::getenv("OCTOPAIR_TEST_SEED")) return std::strtoull(seed, nullptr, 10);
    std::uint64_t salt = 0;
    for (const char c : kind) salt = samples::mix_bits(salt + std::uint64_t(c));
    return samples::mix_bits(salt + i) >> 1;
}

}  // namespace octopair::test
