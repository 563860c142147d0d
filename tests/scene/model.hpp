// Model of a scene: computes the expected results of each step by brute force over all pairs of objects.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <vector>

#include "octopair/octopair.hpp"

namespace octopair::test {

struct ModelObject {
    ObjectId id;
    Box3d box;
    double padding = 0;
    Traits traits;
};

/// Returns whether two objects are a pair, by an independent implementation of the scene's rule.
inline bool are_pair(const ModelObject& a, const ModelObject& b, double margin) {
    if ((a.traits.mask & b.traits.groups) == 0 || (b.traits.mask & a.traits.groups) == 0) return false;
    if (a.traits.fixed && b.traits.fixed) return false;
    for (int axis = 0; axis < 3; ++axis) {
        const double gap = std::max(a.box.min[axis] - b.box.max[axis], b.box.min[axis] - a.box.max[axis]);
        if (!(gap <= margin + (a.padding + b.padding))) return false;
    }
    return true;
}

class Model {
public:
    explicit Model(double margin = 0) : margin_(margin) {}

    std::map<std::uint32_t, ModelObject> objects;  ///< by index

    std::vector<Pair> pairs() const {
        std::vector<Pair> found;
        for (auto a = objects.begin(); a != objects.end(); ++a) {
            for (auto b = std::next(a); b != objects.end(); ++b) {
                if (are_pair(a->second, b->second, margin_)) found.push_back({a->first, b->first});
            }
        }
        return found;
    }

    /// Compares a step of the scene with the last step of the model.
    template <typename AnyScene>
    void check(AnyScene& scene) {
        const StepResult& result = scene.step();
        SCOPED_TRACE(result.full ? "full" : "partial");
        const std::vector<Pair> now = pairs();
        std::vector<Pair> began, ended, kept;
        std::set_difference(now.begin(), now.end(), before_.begin(), before_.end(), std::back_inserter(began));
        std::set_difference(before_.begin(), before_.end(), now.begin(), now.end(), std::back_inserter(ended));
        std::set_intersection(now.begin(), now.end(), before_.begin(), before_.end(), std::back_inserter(kept));
        ASSERT_EQ(std::vector<Pair>(result.began.begin(), result.began.end()), began);
        ASSERT_EQ(std::vector<Pair>(result.ended.begin(), result.ended.end()), ended);
        ASSERT_EQ(result.persisting, kept.size());
        ASSERT_EQ(result.pairs(), now.size());
        ASSERT_EQ(scene.size(), objects.size());
        full_ += result.full ? 1 : 0;
        partial_ += result.full ? 0 : 1;
        before_ = now;
        kept_ = kept;
    }

    /// Compares the lists of the scene with the last step of the model.
    template <typename AnyScene>
    void check_lists(AnyScene& scene) const {
        ASSERT_EQ(scene.pairs().to_vector(), before_);
        ASSERT_EQ(scene.persisting().to_vector(), kept_);
        if constexpr (requires { scene.enlarged_pairs(); }) {
            const std::vector<Pair> enlarged = scene.enlarged_pairs().to_vector();
            ASSERT_TRUE(std::is_sorted(enlarged.begin(), enlarged.end()));
            ASSERT_TRUE(std::includes(enlarged.begin(), enlarged.end(), before_.begin(), before_.end()));
        }
    }

    int full() const { return full_; }
    int partial() const { return partial_; }

private:
    double margin_;
    std::vector<Pair> before_, kept_;
    int full_ = 0, partial_ = 0;
};

}  // namespace octopair::test
