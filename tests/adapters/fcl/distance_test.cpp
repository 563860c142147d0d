// distance(): smallest distances, and the pairs that are called.
#include <fcl/broadphase/default_broadphase_callbacks.h>

#include <map>
#include <type_traits>

#include "world.hpp"

namespace octopair::test {
namespace {

using octopair::fcl::BoundingBoxes;
using octopair::fcl::BroadPhaseManager;

template <typename S>
class FclDistance : public ::testing::Test {};
using Reals = ::testing::Types<float, double>;
TYPED_TEST_SUITE(FclDistance, Reals);

TYPED_TEST(FclDistance, IsThatOfTheNaiveManager) {
    using S = TypeParam;
    for (const std::size_t count : {1u, 2u, 3u, 10u, 300u}) {
        for (const double size : {0.05, 0.5, 2.0}) {
            FclWorld<S> world(count, 40);
            const std::vector<FclObject<S>*> objects = world.add_random(count, size);
            const std::vector<FclObject<S>*> others = world.add_random(20, size);
            BroadPhaseManager<S> manager({.boxes = BoundingBoxes::fcl}), same({.boxes = BoundingBoxes::fcl});
            ::fcl::NaiveCollisionManager<S> naive, naive_others;
            manager.registerObjects(objects);
            same.registerObjects(others);
            naive.registerObjects(objects);
            naive_others.registerObjects(others);
            EXPECT_EQ(smallest_distance<S>(manager), smallest_distance<S>(naive));
            for (FclObject<S>* const object : others) {
                EXPECT_EQ(smallest_distance<S>(manager, object), smallest_distance<S>(naive, object));
            }
            using Manager = ::fcl::BroadPhaseCollisionManager<S>;
            const S expected = smallest_distance<S>(naive, static_cast<Manager*>(&naive_others));
            EXPECT_EQ(smallest_distance<S>(manager, static_cast<Manager*>(&same)), expected);
            EXPECT_EQ(smallest_distance<S>(same, static_cast<Manager*>(&manager)), expected);
            EXPECT_EQ(smallest_distance<S>(manager, static_cast<Manager*>(&naive_others)), expected);
            EXPECT_EQ(smallest_distance<S>(manager, static_cast<Manager*>(&manager)), smallest_distance<S>(manager));
        }
    }
}

/// A search that does not lower its limit below `least`.
template <typename S>
struct Threshold {
    S least;
    FclPairs<S> pairs = {};
    static bool call(FclObject<S>* a, FclObject<S>* b, void* data, S& dist) {
        auto& search = *static_cast<Threshold*>(data);
        search.pairs.emplace_back(a, b);
        dist = search.least;
        return false;
    }
};

TYPED_TEST(FclDistance, CallsAllPairsBelowTheLimitOnce) {
    using S = TypeParam;
    FclWorld<S> world(3, 20);
    std::vector<FclObject<S>*> objects = world.add_random(400, 1);
    for (int i = 0; i < 20; ++i) objects.push_back(world.add_box(1, 2, 3));
    const std::vector<FclObject<S>*> others = world.add_random(30, 1);
    BroadPhaseManager<S> manager, other;
    manager.registerObjects(objects);
    other.registerObjects(others);
    using Manager = ::fcl::BroadPhaseCollisionManager<S>;
    for (const S limit : {S(0.01), S(0.5), S(3), S(9), std::numeric_limits<S>::max()}) {
        const auto near = [&](const FclObject<S>& a, const FclObject<S>& b) {
            return box_distance(box_of(a, BoundingBoxes::tight), box_of(b, BoundingBoxes::tight)) < double(limit);
        };
        // Pairs are called before the first call has set the limit, so some called pairs may be farther.
        const auto check = [&](FclPairs<S> called, const FclPairs<S>& expected) {
            std::erase_if(called, [&](const auto& pair) { return !near(*pair.first, *pair.second); });
            EXPECT_EQ(sorted<S>(called), sorted<S>(expected));
        };
        Threshold<S> self{limit}, one{limit}, ours{limit}, theirs{limit};
        manager.distance(&self, Threshold<S>::call);
        manager.distance(others[0], &one, Threshold<S>::call);
        manager.distance(static_cast<Manager*>(&other), &ours, Threshold<S>::call);
        other.distance(static_cast<Manager*>(&manager), &theirs, Threshold<S>::call);
        FclPairs<S> expected_self, expected_one, expected_ours, expected_theirs;
        for (std::size_t i = 0; i < objects.size(); ++i) {
            for (std::size_t j = i + 1; j < objects.size(); ++j) {
                if (near(*objects[i], *objects[j])) expected_self.emplace_back(objects[i], objects[j]);
            }
            if (near(*objects[i], *others[0])) expected_one.emplace_back(objects[i], others[0]);
            for (FclObject<S>* const object : others) {
                if (near(*objects[i], *object)) expected_ours.emplace_back(objects[i], object);
            }
        }
        check(self.pairs, expected_self);
        check(one.pairs, expected_one);
        check(ours.pairs, expected_ours);
        check(theirs.pairs, expected_ours);
        const auto is_ours = [&](const auto& pair) {
            return std::find(objects.begin(), objects.end(), pair.first) != objects.end();
        };
        EXPECT_TRUE(std::all_of(ours.pairs.begin(), ours.pairs.end(), is_ours));
        EXPECT_TRUE(std::none_of(theirs.pairs.begin(), theirs.pairs.end(), is_ours));
    }
}

TYPED_TEST(FclDistance, OfNoneAndOneObject) {
    using S = TypeParam;
    FclWorld<S> world(1);
    BroadPhaseManager<S> manager;
    FclObject<S>* const object = world.add_box(0, 0, 0);
    constexpr S none = std::numeric_limits<S>::max();
    EXPECT_EQ(smallest_distance<S>(manager), none);
    EXPECT_EQ(smallest_distance<S>(manager, object), none);
    manager.registerObject(object);
    EXPECT_EQ(smallest_distance<S>(manager), none);
    EXPECT_EQ(smallest_distance<S>(manager, object), none);  // no pair with itself
    EXPECT_EQ(smallest_distance<S>(manager, world.add_box(3, 0, 0)), 2);
}

/// A search for the smallest distance of shapes, by FCL's callback. FCL's library computes this distance only in double precision; to
/// compile the computation for float takes half a minute. So the callback gets copies of the objects.
template <typename S>
struct ShapeDistance {
    std::map<const FclObject<S>*, FclObject<double>*> copies;
    ::fcl::DefaultDistanceData<double> data;

    static bool call(FclObject<S>* a, FclObject<S>* b, void* search, S& dist) {
        auto& [copies, data] = *static_cast<ShapeDistance*>(search);
        double found = double(dist);
        const bool done = ::fcl::DefaultDistanceFunction(copies.at(a), copies.at(b), &data, found);
        dist = S(found);
        return done;
    }
};

TYPED_TEST(FclDistance, OfGeometryIsThatOfFclsTree) {
    using S = TypeParam;
    FclWorld<S> world(9);
    FclWorld<double> copied_world(9);
    std::vector<FclObject<S>*> objects;
    ShapeDistance<S> ours;
    for (int i = 0; i < 216; ++i) {
        const auto place = [&](auto* object) {
            using Number = std::decay_t<decltype(object->getTranslation()[0])>;
            object->setTranslation(
                ::fcl::Vector3<Number>(Number(2 * (i % 6)), Number(2 * (i / 6 % 6)), Number(2 * (i / 36))));
            object->computeAABB();
            return object;
        };
        objects.push_back(place(world.add_random(1)));
        ours.copies[objects.back()] = place(copied_world.add_random(1));
    }
    BroadPhaseManager<S> manager;
    ::fcl::DynamicAABBTreeCollisionManager<S> tree;
    manager.registerObjects(objects);
    tree.registerObjects(objects);
    tree.setup();
    ShapeDistance<S> theirs = ours;
    manager.distance(&ours, ShapeDistance<S>::call);
    tree.distance(&theirs, ShapeDistance<S>::call);
    EXPECT_GT(ours.data.result.min_distance, 0);
    EXPECT_NEAR(ours.data.result.min_distance, theirs.data.result.min_distance, 1e-4);
}

TEST(FclLarge, DistancesAfterMoves) {
    FclWorld<double> world(10, 100);
    const std::vector<FclObject<double>*> objects = world.add_random(3'000, 0.1);
    BroadPhaseManager<double> manager({.boxes = BoundingBoxes::fcl});
    ::fcl::NaiveCollisionManager<double> naive;
    manager.registerObjects(objects);
    naive.registerObjects(objects);
    for (const std::size_t stride : {1u, 100u, 1'000u, 30u}) {
        for (std::size_t i = 0; i < objects.size(); i += stride) world.move(*objects[i]);
        manager.update();
        EXPECT_EQ(smallest_distance<double>(manager), smallest_distance<double>(naive));
        for (std::size_t i = 0; i < 600; ++i) {
            FclObject<double>& object = *objects[i];
            manager.unregisterObject(&object);
            naive.unregisterObject(&object);
            ASSERT_EQ(smallest_distance<double>(manager, &object), smallest_distance<double>(naive, &object));
            manager.registerObject(&object);
            naive.registerObject(&object);
        }
    }
}

}  // namespace
}  // namespace octopair::test
