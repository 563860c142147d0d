// Tests of all pairs: the naive solution of the paper's section 2.3, and the oracle of the tests.
#include <algorithm>
#include <variant>

#include "baselines/baselines.hpp"
#include "baselines/overlap.hpp"

namespace octopair::baselines {

namespace {

template <typename Real>
std::vector<Pair> test_all(std::span<const Box<Real>> boxes) {
    std::vector<Pair> pairs;
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
        for (std::uint32_t j = i + 1; j < boxes.size(); ++j) {
            if (overlap(boxes[i], boxes[j])) pairs.push_back({i, j});
        }
    }
    return pairs;
}

/// Values of an object that the overlap rule uses.
struct Judged {
    double min[3], max[3];
    double padding;
};

std::vector<Judged> judged(const Objects& objects) {
    std::vector<Judged> result;
    const auto append = [&](auto boxes) {
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const auto& box = boxes[i];
            result.push_back({{double(box.min[0]), double(box.min[1]), double(box.min[2])},
                              {double(box.max[0]), double(box.max[1]), double(box.max[2])},
                              objects.padding.empty() ? 0 : objects.padding[i]});
        }
    };
    std::visit(append, objects.boxes);
    return result;
}

bool counts(const Judged& a, const Judged& b, double margin) {
    const double clearance = margin + (a.padding + b.padding);
    for (int axis = 0; axis < 3; ++axis) {
        if (std::max(a.min[axis] - b.max[axis], b.min[axis] - a.max[axis]) > clearance) return false;
    }
    return true;
}

}  // namespace

std::vector<Pair> ascending(std::vector<Pair> pairs) {
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

std::vector<Pair> naive_pairs(std::span<const Box3f> boxes) { return test_all(boxes); }
std::vector<Pair> naive_pairs(std::span<const Box3d> boxes) { return test_all(boxes); }

std::vector<Pair> oracle_pairs(const Objects& objects, double margin) {
    const std::vector<Judged> all = judged(objects);
    std::vector<Pair> pairs;
    for (std::uint32_t i = 0; i < all.size(); ++i) {
        for (std::uint32_t j = i + 1; j < all.size(); ++j) {
            if (counts(all[i], all[j], margin)) pairs.push_back({i, j});
        }
    }
    return pairs;
}

std::vector<Pair> oracle_pairs_between(const Objects& first, const Objects& second, double margin) {
    const std::vector<Judged> left = judged(first), right = judged(second);
    std::vector<Pair> pairs;
    for (std::uint32_t i = 0; i < left.size(); ++i) {
        for (std::uint32_t j = 0; j < right.size(); ++j) {
            if (counts(left[i], right[j], margin)) pairs.push_back({i, j});
        }
    }
    return pairs;
}

}  // namespace octopair::baselines
