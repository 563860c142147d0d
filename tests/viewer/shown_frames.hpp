// Frames for tests of the viewer, and their true pairs.
#pragma once

#include <algorithm>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "viewer/scene/scene_contents.hpp"

namespace octopair::test {

using Json = nlohmann::json;

/// Returns whether two boxes form a pair, by the rule in objects.hpp, without padding.
inline bool is_pair(const Box3d& a, const Box3d& b, double margin = 0) {
    for (int i = 0; i < 3; ++i) {
        if (std::max(a.min[i] - b.max[i], b.min[i] - a.max[i]) > margin) return false;
    }
    return true;
}

/// Returns the pairs of the boxes that exist, ascending.
inline std::vector<Pair> true_pairs(const std::vector<Box3d>& boxes, const std::vector<std::uint8_t>& exists = {},
                                    double margin = 0) {
    std::vector<Pair> pairs;
    for (std::uint32_t a = 0; a < boxes.size(); ++a) {
        for (std::uint32_t b = a + 1; b < boxes.size(); ++b) {
            if (!exists.empty() && (exists[a] == 0 || exists[b] == 0)) continue;
            if (is_pair(boxes[a], boxes[b], margin)) pairs.push_back({a, b});
        }
    }
    return pairs;
}

using Random = std::mt19937_64;

inline double random_number(Random& random, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
}

/// Makes boxes in a cube, about `density` pairs per object. All coordinates are float32.
inline std::vector<Box3d> random_boxes(Random& random, std::size_t count, double density = 3) {
    const double extent = std::cbrt(double(std::max<std::size_t>(count, 1)) * 8 / density) + 1;
    std::vector<Box3d> boxes(count);
    for (Box3d& box : boxes) {
        for (int i = 0; i < 3; ++i) {
            box.min[i] = double(float(random_number(random, 0, extent)));
            box.max[i] = double(float(box.min[i] + random_number(random, 0, 2)));
        }
    }
    return boxes;
}

/// Makes a frame that owns its boxes.
inline viewer::FrameData frame_of(std::vector<Box3d> boxes, std::vector<std::uint8_t> exists = {}) {
    viewer::FrameData data;
    data.pairs = true_pairs(boxes, exists);
    data.pair_count = data.pairs.size();
    const auto owned = std::make_shared<const std::vector<Box3d>>(std::move(boxes));
    data.boxes = std::span<const Box3d>(*owned);
    data.keep = owned;
    data.exists = std::move(exists);
    return data;
}

/// Returns the elements of an array in an answer. Fails if bytes are left.
template <typename T>
std::vector<T> array_of(const std::string& bytes) {
    EXPECT_EQ(bytes.size() % sizeof(T), 0u);
    std::vector<T> values(bytes.size() / sizeof(T));
    if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
}

}  // namespace octopair::test
