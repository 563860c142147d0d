// Boxes of FCL's objects: tight, containing the geometry, unbounded, invalid.
#include "octopair/error.hpp"
#include "support/errors.hpp"
#include "world.hpp"

namespace octopair::test {
namespace {

using octopair::fcl::BoundingBoxes;
using octopair::fcl::BroadPhaseManager;

template <typename S>
class FclBoxes : public ::testing::Test {};
using Reals = ::testing::Types<float, double>;
TYPED_TEST_SUITE(FclBoxes, Reals);

/// Returns the corners of the local box under the object's transform, in higher precision.
template <typename S>
std::vector<std::array<long double, 3>> corners(const FclObject<S>& object) {
    const auto& local = object.collisionGeometry()->aabb_local;
    std::vector<std::array<long double, 3>> result;
    for (int corner = 0; corner < 8; ++corner) {
        std::array<long double, 3> place;
        for (int axis = 0; axis < 3; ++axis) {
            place[std::size_t(axis)] = object.getTransform().translation()[axis];
            for (int from = 0; from < 3; ++from) {
                const S coordinate = (corner >> from & 1) != 0 ? local.max_[from] : local.min_[from];
                place[std::size_t(axis)] +=
                    static_cast<long double>(object.getTransform().linear()(axis, from)) * coordinate;
            }
        }
        result.push_back(place);
    }
    return result;
}

TYPED_TEST(FclBoxes, ContainTheGeometryAndAreTight) {
    using S = TypeParam;
    for (const double side : {1e-30, 1e-3, 10.0, 1e9}) {
        FclWorld<S> world(1, side);
        for (int i = 0; i < 500; ++i) {
            const FclObject<S>& object = *world.add_random(1e-3 + side / 20);
            const Box3d box = box_of(object, BoundingBoxes::tight);
            std::array<long double, 3> lower, upper;
            lower.fill(std::numeric_limits<long double>::max());
            upper.fill(-std::numeric_limits<long double>::max());
            for (const auto& corner : corners(object)) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    lower[axis] = std::min(lower[axis], corner[axis]);
                    upper[axis] = std::max(upper[axis], corner[axis]);
                }
            }
            const double most = 30 * std::numeric_limits<S>::epsilon() * (side + 1);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                ASSERT_LE(box.min[axis], lower[axis]);
                ASSERT_GE(box.max[axis], upper[axis]);
                ASSERT_GE(box.min[axis], double(lower[axis]) - most);
                ASSERT_LE(box.max[axis], double(upper[axis]) + most);
            }
        }
    }
}

TYPED_TEST(FclBoxes, AreNotRoundedIfTheyAreExact) {
    using S = TypeParam;
    FclWorld<S> world(1);
    const Box3d box = box_of(*world.add_box(2, 3, 4), BoundingBoxes::tight);
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(box.min[axis], 1.5 + axis);
        EXPECT_EQ(box.max[axis], 2.5 + axis);
    }
}

TYPED_TEST(FclBoxes, AreThoseOfFclOnRequest) {
    using S = TypeParam;
    FclWorld<S> world(1);
    for (int i = 0; i < 100; ++i) {
        const FclObject<S>& object = *world.add_random();
        const Box3d box = box_of(object, BoundingBoxes::fcl);
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_EQ(box.min[axis], object.getAABB().min_[axis]);
            EXPECT_EQ(box.max[axis], object.getAABB().max_[axis]);
        }
    }
}

/// Planes and half-spaces in directions of axes and in others, without and with rotation.
template <typename S>
std::vector<FclObject<S>*> add_unbounded(FclWorld<S>& world) {
    std::vector<FclObject<S>*> objects;
    for (const auto& normal : {::fcl::Vector3<S>(1, 0, 0), ::fcl::Vector3<S>(0, -1, 0), ::fcl::Vector3<S>(1, 2, 3)}) {
        objects.push_back(world.add(std::make_shared<::fcl::Plane<S>>(normal, S(0.5))));
        objects.push_back(world.add(std::make_shared<::fcl::Halfspace<S>>(normal, S(0.5))));
        objects.push_back(world.add(std::make_shared<::fcl::Plane<S>>(normal, S(0.5))));
        world.move(*objects.back());
    }
    return objects;
}

TYPED_TEST(FclBoxes, MayBeUnbounded) {
    using S = TypeParam;
    for (const BoundingBoxes kind : {BoundingBoxes::tight, BoundingBoxes::fcl}) {
        FclWorld<S> world(2);
        std::vector<FclObject<S>*> objects = add_unbounded(world);
        for (FclObject<S>* const object : world.add_random(300, 0.5)) objects.push_back(object);
        BroadPhaseManager<S> manager({.boxes = kind});
        manager.registerObjects(objects);
        const FclPairs<S> expected = overlapping_pairs(objects, kind);
        EXPECT_EQ(collide<S>(manager), expected);
        // Each object overlaps the half-space with an oblique normal.
        EXPECT_GE(expected.size(), objects.size() - 1);
        if (kind == BoundingBoxes::tight) continue;
        ::fcl::NaiveCollisionManager<S> naive;
        naive.registerObjects(objects);
        EXPECT_EQ(expected, collide<S>(naive));
        EXPECT_EQ(smallest_distance<S>(manager), 0);
        for (FclObject<S>* const object : objects) {
            ::fcl::NaiveCollisionManager<S> others;
            for (FclObject<S>* const other : objects) {
                if (other != object) others.registerObject(other);
            }
            ASSERT_EQ(smallest_distance<S>(manager, object), smallest_distance<S>(others, object));
        }
    }
}

TYPED_TEST(FclBoxes, ThatAreInvalidAreRefused) {
    using S = TypeParam;
    FclWorld<S> world(1);
    FclObject<S>* const good = world.add_box(0, 0, 0);
    FclObject<S>* const bad = world.add_box(0, 0, 0);
    BroadPhaseManager<S> manager;
    const auto refusal = [](auto&& call) { return error_of(ErrorCode::bad_input, call); };
    bad->setTranslation(::fcl::Vector3<S>(0, std::numeric_limits<S>::quiet_NaN(), 0));
    EXPECT_EQ(refusal([&] {
                  manager.registerObjects({good, bad});
              }),
              "octopair::fcl: bounding box of object 1 of the call: min.y (nan) or max.y (nan) is not a number");
    EXPECT_TRUE(manager.empty());
    FclCalls<S> calls;
    manager.registerObject(good);
    EXPECT_THROW(manager.collide(bad, &calls, FclCalls<S>::collide), Error);
    FclObject<S>* const empty = world.add_box(0, 0, 0);
    manager.registerObject(empty);
    auto* const shape = const_cast<::fcl::CollisionGeometry<S>*>(empty->collisionGeometry().get());
    shape->aabb_local.min_[2] = 3;
    const std::string is_empty = " min.z (3.000000) is greater than max.z (0.500000)";
    EXPECT_EQ(refusal([&] { manager.update(); }), "octopair::fcl: bounding box of registered object 1:" + is_empty);
    EXPECT_EQ(collide<S>(manager).size(), 1u);  // nothing has changed
}

}  // namespace
}  // namespace octopair::test
