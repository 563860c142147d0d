// Tests that a pair of any kinds stores at most the contacts that were asked for: the first ones of all.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "narrow_phase/object_pair.hpp"
#include "samples/meshes.hpp"

namespace octopair::test {
namespace {

struct Kind {
    std::string name;
    Geometry geometry;
    Pose pose;
};

/// Returns objects that all meet each other, two of which are meshes with many triangles.
std::vector<Kind> meeting_objects() {
    return {{"mesh", Geometry(samples::sphere_mesh(1, 3)), make_pose({0, 0, 0})},
            {"other mesh", Geometry(samples::sphere_mesh(1, 3)), make_pose({0.1, 0.2, 0.3}, {1, 2, 3, 4})},
            {"box", Geometry(shape::Box{{2, 2, 0.1}}), make_pose({0, 0, 0.05})},
            {"hull", Geometry(shape::ConvexHull{{{-2, -2, 0}, {2, -2, 0}, {0, 3, 0.25}}}), make_pose({0, 0, 0})},
            {"capsule", Geometry(shape::Capsule{0.2, 4}), make_pose({0, 0, 0})},
            {"plane", Geometry(shape::Plane{{0, 0, 1}, 0}), make_pose({0, 0, 0})}};
}

Finding found(const Kind& a, const Kind& b, std::uint32_t max_contacts) {
    Finding finding;
    const PosedObject first{detail::prepared(a.geometry), a.pose}, second{detail::prepared(b.geometry), b.pose};
    EXPECT_TRUE(judge_objects(first, second, 0, finding));
    find_contacts(first, second, {max_contacts, {}}, finding);
    return finding;
}

bool same(const Contact& a, const Contact& b) {
    return a.point == b.point && a.normal == b.normal && a.depth == b.depth && a.feature_a == b.feature_a &&
           a.feature_b == b.feature_b;
}

TEST(ContactLimit, TheFirstContactsOfAllAreStored) {
    const std::vector<Kind> objects = meeting_objects();
    std::size_t most = 0;
    for (const Kind& a : objects) {
        for (const Kind& b : objects) {
            if (&a == &b) continue;
            SCOPED_TRACE(a.name + " and " + b.name);
            const Finding all = found(a, b, 1u << 30);
            EXPECT_FALSE(all.more_contacts);
            most = std::max(most, all.contacts.size());
            for (const std::uint32_t limit : {0u, 1u, 20u}) {
                const Finding some = found(a, b, limit);
                ASSERT_EQ(some.contacts.size(), std::min<std::size_t>(limit, all.contacts.size()));
                EXPECT_LE(some.contacts.capacity(), 64u) << "memory for contacts that are not stored";
                EXPECT_EQ(some.more_contacts, all.contacts.size() > limit);
                EXPECT_TRUE(std::equal(some.contacts.begin(), some.contacts.end(), all.contacts.begin(), same));
                EXPECT_EQ(some.depth, all.depth);
                EXPECT_EQ(some.collision_class, all.collision_class);
            }
        }
    }
    EXPECT_GT(most, 100u);
}

}  // namespace
}  // namespace octopair::test
