// collide(): pairs, their order, early stops, and other managers.
#include "world.hpp"

namespace octopair::test {
namespace {

using octopair::fcl::BoundingBoxes;
using octopair::fcl::BroadPhaseManager;

template <typename S>
class FclCollide : public ::testing::Test {};
using Reals = ::testing::Types<float, double>;
TYPED_TEST_SUITE(FclCollide, Reals);

TYPED_TEST(FclCollide, FindsAllPairsInTheOrderOfRegistration) {
    using S = TypeParam;
    for (const BoundingBoxes kind : {BoundingBoxes::tight, BoundingBoxes::fcl}) {
        FclWorld<S> world(3);
        const std::vector<FclObject<S>*> objects = world.add_random(300, 2);
        BroadPhaseManager<S> manager({.threads = 2, .boxes = kind});
        manager.registerObjects(objects);
        manager.setup();
        const FclPairs<S> expected = overlapping_pairs(objects, kind);
        EXPECT_GT(expected.size(), 300u);
        EXPECT_EQ(collide<S>(manager), expected);
        if (kind == BoundingBoxes::tight) continue;
        ::fcl::NaiveCollisionManager<S> naive;
        naive.registerObjects(objects);
        EXPECT_EQ(collide<S>(naive), expected);
    }
}

TYPED_TEST(FclCollide, KeepsTheOrderOfRegistrationAfterObjectsWereRemoved) {
    using S = TypeParam;
    FclWorld<S> world(4);
    std::vector<FclObject<S>*> objects = world.add_random(200, 3);
    BroadPhaseManager<S> manager;
    manager.registerObjects(objects);
    for (int round = 0; round < 4; ++round) {
        for (int i = 0; i < 20; ++i) {  // the objects move to the end
            const auto at = objects.begin() + std::ptrdiff_t(world.random() % objects.size());
            manager.unregisterObject(*at);
            std::rotate(at, at + 1, objects.end());
            if (i % 2 == 0) (void)collide<S>(manager);
            manager.registerObject(objects.back());
        }
        EXPECT_EQ(collide<S>(manager), overlapping_pairs(objects, BoundingBoxes::tight));
        std::vector<FclObject<S>*> registered;
        manager.getObjects(registered);
        EXPECT_EQ(registered, objects);
        const FclObject<S>& query = *objects[7];
        FclPairs<S> expected;
        for (FclObject<S>* const object : objects) {
            const bool overlap =
                boxes_overlap(box_of(*object, BoundingBoxes::tight), box_of(query, BoundingBoxes::tight));
            if (object != &query && overlap) expected.emplace_back(object, objects[7]);
        }
        EXPECT_EQ(collide<S>(manager, objects[7]), expected);
    }
}

TYPED_TEST(FclCollide, CountsBoxesThatTouch) {
    using S = TypeParam;
    FclWorld<S> world(1);
    FclObject<S>* const a = world.add_box(0, 0, 0);
    FclObject<S>* const b = world.add_box(1, 1, 1);
    FclObject<S>* const c = world.add_box(2.0001, 1, 1);
    BroadPhaseManager<S> manager;
    manager.registerObjects({a, b, c});
    EXPECT_EQ(collide<S>(manager), (FclPairs<S>{{a, b}}));
}

TYPED_TEST(FclCollide, OfNoneOneAndCoincidentObjects) {
    using S = TypeParam;
    FclWorld<S> world(1);
    BroadPhaseManager<S> manager;
    EXPECT_TRUE(manager.empty());
    EXPECT_TRUE(collide<S>(manager).empty());
    FclObject<S>* const first = world.add_box(0, 0, 0);
    EXPECT_TRUE(collide<S>(manager, first).empty());
    manager.update();
    manager.unregisterObject(first);
    manager.registerObject(first);
    EXPECT_EQ(manager.size(), 1u);
    EXPECT_TRUE(collide<S>(manager).empty());
    EXPECT_TRUE(collide<S>(manager, first).empty());  // no pair with itself
    std::vector<FclObject<S>*> objects{first};
    for (int i = 0; i < 100; ++i) {
        objects.push_back(world.add_box(0, 0, 0));
        manager.registerObject(objects.back());
    }
    manager.registerObjects(objects);  // all are registered already
    EXPECT_EQ(manager.size(), 101u);
    EXPECT_EQ(collide<S>(manager).size(), 101u * 100 / 2);
    manager.clear();
    EXPECT_TRUE(manager.empty());
    EXPECT_TRUE(collide<S>(manager).empty());
    manager.registerObjects({objects[5], objects[5], objects[3]});
    EXPECT_EQ(collide<S>(manager), (FclPairs<S>{{objects[5], objects[3]}}));
}

TYPED_TEST(FclCollide, ReadsBoxesOnlyInUpdates) {
    using S = TypeParam;
    FclWorld<S> world(1);
    FclObject<S>* const a = world.add_box(0, 0, 0);
    FclObject<S>* const b = world.add_box(5, 0, 0);
    BroadPhaseManager<S> manager;
    manager.registerObjects({a, b});
    b->setTranslation(::fcl::Vector3<S>(1, 0, 0));
    EXPECT_TRUE(collide<S>(manager).empty());
    manager.update(a);
    EXPECT_TRUE(collide<S>(manager).empty());
    manager.update(b);
    EXPECT_EQ(collide<S>(manager).size(), 1u);
    a->setTranslation(::fcl::Vector3<S>(-5, 0, 0));
    manager.update(std::vector<FclObject<S>*>{world.add_box(0, 0, 0), a});  // the first object is not registered
    EXPECT_TRUE(collide<S>(manager).empty());
    b->setTranslation(::fcl::Vector3<S>(-5, 0, 0));
    manager.setup();
    EXPECT_EQ(collide<S>(manager).size(), 1u);
}

TYPED_TEST(FclCollide, EndsWhenTheCallbackReturnsTrue) {
    using S = TypeParam;
    FclWorld<S> world(5);
    const std::vector<FclObject<S>*> objects = world.add_random(100, 4), more = world.add_random(100, 4);
    BroadPhaseManager<S> manager, other;
    manager.registerObjects(objects);
    other.registerObjects(more);
    const auto first = [&](std::size_t most, auto... argument) {
        FclCalls<S> calls{.most = most};
        manager.collide(argument..., &calls, FclCalls<S>::collide);
        return calls.pairs;
    };
    const auto begin = [](FclPairs<S> pairs, std::size_t count) {
        pairs.resize(count);
        return pairs;
    };
    for (const std::size_t most : {1u, 2u, 7u}) {
        EXPECT_EQ(first(most), begin(collide<S>(manager), most));
        EXPECT_EQ(first(most, more[0]), begin(collide<S>(manager, more[0]), most));
        ::fcl::BroadPhaseCollisionManager<S>* const argument = &other;
        EXPECT_EQ(first(most, argument), begin(collide<S>(manager, argument), most));
    }
    FclCalls<S> calls{.most = 3};
    manager.distance(&calls, FclCalls<S>::distance);
    EXPECT_EQ(calls.pairs.size(), 3u);
}

TYPED_TEST(FclCollide, WithOtherManagers) {
    using S = TypeParam;
    for (const auto& [count, other_count] : {std::pair(200, 150), {3, 200}, {200, 3}, {0, 5}, {5, 0}}) {
        FclWorld<S> world(6);
        const std::vector<FclObject<S>*> objects = world.add_random(std::size_t(count), 2);
        std::vector<FclObject<S>*> others = world.add_random(std::size_t(other_count), 2);
        if (count > 0) others.push_back(objects[0]);  // an object in both managers forms no pair with itself
        const BoundingBoxes kind = BoundingBoxes::fcl;
        FclPairs<S> expected;
        for (FclObject<S>* const a : objects) {
            for (FclObject<S>* const b : others) {
                if (a != b && boxes_overlap(box_of(*a, kind), box_of(*b, kind))) expected.emplace_back(a, b);
            }
        }
        BroadPhaseManager<S> manager({.boxes = kind}), same({.boxes = kind});
        manager.registerObjects(objects);
        same.registerObjects(others);
        ::fcl::DynamicAABBTreeCollisionManager<S> tree;
        for (FclObject<S>* const object : others) tree.registerObject(object);
        tree.setup();
        EXPECT_EQ(collide<S>(manager, static_cast<::fcl::BroadPhaseCollisionManager<S>*>(&same)), expected);
        const FclPairs<S> with_tree = collide<S>(manager, static_cast<::fcl::BroadPhaseCollisionManager<S>*>(&tree));
        EXPECT_EQ(sorted<S>(with_tree), sorted<S>(expected));
        for (const auto& [a, b] : with_tree) {
            EXPECT_NE(std::find(objects.begin(), objects.end(), a), objects.end());  // the first argument is ours
            EXPECT_NE(std::find(others.begin(), others.end(), b), others.end());
        }
        ::fcl::BroadPhaseCollisionManager<S>* const itself = &manager;
        EXPECT_EQ(collide<S>(manager, itself), collide<S>(manager));
    }
}

TYPED_TEST(FclCollide, CallbacksMayCallTheManager) {
    using S = TypeParam;
    FclWorld<S> world(7);
    const std::vector<FclObject<S>*> objects = world.add_random(60, 3);
    BroadPhaseManager<S> manager;
    manager.registerObjects(objects);
    struct Data {
        const BroadPhaseManager<S>* manager;
        FclPairs<S> pairs;
        std::size_t nested = 0;
    } data{&manager, {}};
    const auto callback = [](FclObject<S>* a, FclObject<S>* b, void* raw) {
        auto& of = *static_cast<Data*>(raw);
        of.pairs.emplace_back(a, b);
        of.nested += collide<S>(*of.manager).size() + collide<S>(*of.manager, a).size();
        (void)smallest_distance<S>(*of.manager, b);
        return false;
    };
    const FclPairs<S> expected = collide<S>(manager);
    manager.collide(&data, callback);
    EXPECT_EQ(data.pairs, expected);
    EXPECT_GT(data.nested, expected.size() * expected.size());
}

TEST(FclLarge, AMillionPairs) {
    FclWorld<double> world(8, 22);
    const std::vector<FclObject<double>*> objects = world.add_random(30'000, 1.9);
    BroadPhaseManager<double> manager;
    manager.registerObjects(objects);
    const FclPairs<double> expected = overlapping_pairs(objects, BoundingBoxes::tight);
    EXPECT_GT(expected.size(), 900'000u);
    EXPECT_TRUE(collide<double>(manager) == expected);
    for (std::size_t i = 0; i < objects.size(); i += 50) world.move(*objects[i]);
    manager.update();
    EXPECT_TRUE(collide<double>(manager) == overlapping_pairs(objects, BoundingBoxes::tight));
}

}  // namespace
}  // namespace octopair::test
