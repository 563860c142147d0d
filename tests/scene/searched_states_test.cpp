// Tests which states the octrees and the pairs of a scene describe, after each transition.
#include "scene/searched_states.hpp"

#include <gtest/gtest.h>

namespace octopair::test {
namespace {

using enum SearchedStates::Holder;

TEST(SearchedStates, NothingIsHeldAtFirst) {
    const SearchedStates states;
    EXPECT_FALSE(states.has_stepped());
    for (const auto holder : {linear, octree, pairs})
        EXPECT_FALSE(states.is_now(holder) || states.is_last_step(holder));
}

TEST(SearchedStates, AChangeOutdatesAll) {
    SearchedStates states;
    states.hold_now(linear);
    EXPECT_TRUE(states.is_now(linear));
    EXPECT_FALSE(states.is_last_step(linear)) << "there was no step";
    states.end_step();
    EXPECT_TRUE(states.is_now(linear) && states.is_last_step(linear));
    states.change();
    EXPECT_FALSE(states.is_now(linear));
    EXPECT_TRUE(states.is_last_step(linear));
    states.hold_now(octree);
    EXPECT_TRUE(states.is_now(octree));
    EXPECT_FALSE(states.is_last_step(octree));
    states.end_step();
    EXPECT_FALSE(states.is_last_step(linear)) << "it has the step before the last";
    EXPECT_TRUE(states.is_last_step(octree));
}

TEST(SearchedStates, AStepThatFailsLeavesTheLastStep) {
    SearchedStates states;
    states.hold_now(pairs);
    states.hold_now(linear);
    states.end_step();
    states.change();
    states.hold_now(pairs);  // then the step fails
    EXPECT_FALSE(states.is_last_step(pairs));
    EXPECT_TRUE(states.is_last_step(linear));
}

TEST(SearchedStates, StatesThatComeAfterAnUnchangedOneAreNew) {
    SearchedStates states;
    states.end_step();
    states.change();
    states.hold_now(octree);
    states.set_unchanged();
    EXPECT_FALSE(states.is_now(octree));
    states.change();
    EXPECT_FALSE(states.is_now(octree)) << "this change need not be the one before";
    states.hold_last_step(linear);
    EXPECT_TRUE(states.is_last_step(linear));
    EXPECT_FALSE(states.is_now(linear));
}

TEST(SearchedStates, WhatIsForgottenIsHeldNoMore) {
    SearchedStates states;
    states.hold_now(octree);
    states.end_step();
    states.forget(octree);
    EXPECT_FALSE(states.is_now(octree) || states.is_last_step(octree));
    EXPECT_TRUE(states.has_stepped());
}

}  // namespace
}  // namespace octopair::test
