// Random collision objects of FCL, and callbacks that record calls.
#pragma once

#include <fcl/broadphase/broadphase_bruteforce.h>
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/plane.h>
#include <fcl/geometry/shape/sphere.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "octopair/fcl/broad_phase_manager.hpp"

namespace octopair::test {

template <typename S>
using FclObject = ::fcl::CollisionObject<S>;
template <typename S>
using FclPairs = std::vector<std::pair<FclObject<S>*, FclObject<S>*>>;

/// Makes collision objects at random places in a cube around the origin.
template <typename S>
class FclWorld {
public:
    explicit FclWorld(std::uint64_t seed, double side = 10) : random_(seed), side_(side) {}

    FclObject<S>* add(std::shared_ptr<::fcl::CollisionGeometry<S>> shape) {
        objects_.push_back(std::make_unique<FclObject<S>>(std::move(shape)));
        return objects_.back().get();
    }
    FclObject<S>* add_box(double x, double y, double z, double edge = 1) {
        FclObject<S>* const object = add(std::make_shared<::fcl::Box<S>>(S(edge), S(edge), S(edge)));
        object->setTranslation(::fcl::Vector3<S>(S(x), S(y), S(z)));
        object->computeAABB();
        return object;
    }
    /// Adds a shape of random kind and size. Every third one has no rotation.
    FclObject<S>* add_random(double size = 1) {
        FclObject<S>* const object = add(random_shape(size));
        move(*object);
        return object;
    }
    std::vector<FclObject<S>*> add_random(std::size_t count, double size) {
        std::vector<FclObject<S>*> objects;
        for (std::size_t i = 0; i < count; ++i) objects.push_back(add_random(size));
        return objects;
    }
    void move(FclObject<S>& object) {
        const auto unit = [&] { return S(number(-1, 1)); };
        if (random_() % 3 == 0)
            object.setRotation(::fcl::Matrix3<S>::Identity());
        else
            object.setQuatRotation(::fcl::Quaternion<S>(unit(), unit(), unit(), unit()).normalized());
        object.setTranslation(S(side_ / 2) * ::fcl::Vector3<S>(unit(), unit(), unit()));
        object.computeAABB();
    }
    double number(double least, double most) { return std::uniform_real_distribution<>(least, most)(random_); }
    std::uint64_t random() { return random_(); }

private:
    std::shared_ptr<::fcl::CollisionGeometry<S>> random_shape(double size) {
        const S a = S(size * number(0.2, 1)), b = S(size * number(0.2, 1)), c = S(size * number(0.2, 1));
        switch (random_() % 4) {
            case 0:
                return std::make_shared<::fcl::Box<S>>(a, b, c);
            case 1:
                return std::make_shared<::fcl::Sphere<S>>(a / 2);
            case 2:
                return std::make_shared<::fcl::Capsule<S>>(a / 4, b);
            default:
                return std::make_shared<::fcl::Cylinder<S>>(a / 2, b);
        }
    }

    std::mt19937_64 random_;
    double side_;
    std::vector<std::unique_ptr<FclObject<S>>> objects_;
};

/// Calls of a callback. Ends the call after `most` pairs.
template <typename S>
struct FclCalls {
    FclPairs<S> pairs = {};
    std::size_t most = ~std::size_t(0);

    static bool collide(FclObject<S>* a, FclObject<S>* b, void* data) {
        auto& calls = *static_cast<FclCalls*>(data);
        calls.pairs.emplace_back(a, b);
        return calls.pairs.size() == calls.most;
    }
    /// Leaves the limit unchanged.
    static bool distance(FclObject<S>* a, FclObject<S>* b, void* data, S&) { return collide(a, b, data); }
};

/// Returns the pairs with the smaller address first, in ascending order.
template <typename S>
FclPairs<S> sorted(FclPairs<S> pairs) {
    for (auto& [a, b] : pairs) {
        if (b < a) std::swap(a, b);
    }
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

/// A search for the smallest distance of boxes.
template <typename S>
struct FclSmallestDistance {
    S smallest = std::numeric_limits<S>::max();
    std::size_t calls = 0;

    static bool call(FclObject<S>* a, FclObject<S>* b, void* data, S& dist) {
        auto& search = *static_cast<FclSmallestDistance*>(data);
        ++search.calls;
        search.smallest = std::min(search.smallest, a->getAABB().distance(b->getAABB()));
        dist = search.smallest;
        return dist <= 0;
    }
};

template <typename S>
Box3d box_of(const FclObject<S>& object, octopair::fcl::BoundingBoxes kind) {
    return octopair::fcl::detail::to_double(octopair::fcl::detail::box_of_argument(object, kind));
}

inline bool boxes_overlap(const Box3d& a, const Box3d& b) {
    for (int axis = 0; axis < 3; ++axis) {
        if (a.min[axis] > b.max[axis] || b.min[axis] > a.max[axis]) return false;
    }
    return true;
}

inline double box_distance(const Box3d& a, const Box3d& b) {
    double square = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double gap = std::max({0.0, a.min[axis] - b.max[axis], b.min[axis] - a.max[axis]});
        square += gap * gap;
    }
    return std::sqrt(square);
}

/// Returns all pairs of overlapping boxes, in the order of `objects`.
template <typename S>
FclPairs<S> overlapping_pairs(const std::vector<FclObject<S>*>& objects, octopair::fcl::BoundingBoxes kind) {
    std::vector<Box3d> boxes;
    for (const FclObject<S>* const object : objects) boxes.push_back(box_of(*object, kind));
    FclPairs<S> pairs;
    for (std::size_t i = 0; i < objects.size(); ++i) {
        for (std::size_t j = i + 1; j < objects.size(); ++j) {
            if (boxes_overlap(boxes[i], boxes[j])) pairs.emplace_back(objects[i], objects[j]);
        }
    }
    return pairs;
}

/// Returns the pairs that `manager` reports, in order.
template <typename S, typename... Argument>
FclPairs<S> collide(const ::fcl::BroadPhaseCollisionManager<S>& manager, Argument... argument) {
    FclCalls<S> calls;
    manager.collide(argument..., &calls, FclCalls<S>::collide);
    return calls.pairs;
}

template <typename S, typename... Argument>
S smallest_distance(const ::fcl::BroadPhaseCollisionManager<S>& manager, Argument... argument) {
    FclSmallestDistance<S> search;
    manager.distance(argument..., &search, FclSmallestDistance<S>::call);
    return search.smallest;
}

}  // namespace octopair::test
