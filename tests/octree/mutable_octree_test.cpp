// Tests the mutable octree against brute force over cells: it finds every overlap exactly once.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <stop_token>
#include <thread>

#include "boxes/box_source.hpp"
#include "engine/threads/team_output.hpp"
#include "octopair/error.hpp"
#include "octree/build/linear_octree.hpp"
#include "octree/dynamic/mutable_octree.hpp"
#include "octree/dynamic/nearest_search.hpp"
#include "parallel/team.hpp"
#include "support/kinds.hpp"

namespace octopair::test {
namespace {

bool overlap(const CellBox& a, const CellBox& b) {
    for (unsigned axis = 0; axis < 3; ++axis) {
        if (a.lo[axis] > b.hi[axis] || b.lo[axis] > a.hi[axis]) return false;
    }
    return true;
}

/// A linear octree, and the source of its entries.
struct Linear {
    /// Borrows `boxes`.
    explicit Linear(const std::vector<Box3f>& boxes) : objects{boxes} {
        NoPairs none;
        SerialExecutor executor(none);
        octree.build(source, executor, {});
    }

    MutableOctree::LoadBounds load_bounds() const {
        return [this](std::span<Entry> entries) { source.load_bounds(entries); };
    }

    Objects objects;
    BoxSource source{objects, nullptr, 0};
    LinearOctree octree;
};

/// Builds `octree` from `linear` on 3 threads.
void build(MutableOctree& octree, const Linear& linear, const std::stop_token& stop = {}) {
    Team team(3);
    TeamExecutor executor(team);
    octree.build(linear.octree, linear.load_bounds(), executor, stop);
}

/// An octree, and the cells of its objects.
class Changing {
public:
    explicit Changing(const std::vector<Box3f>& boxes) {
        const Linear linear(boxes);
        build(octree_, linear);
        cells_.resize(boxes.size());
        octree_.space().cells(boxes, cells_);
        here_.assign(boxes.size(), true);
    }

    void erase(std::uint32_t object) {
        octree_.erase(object, cells_[object]);
        here_[object] = false;
    }

    void insert(std::uint32_t object, const Box3f& box) {
        octree_.space().cells(std::span(&box, 1), {&cells_[object], 1});
        octree_.insert(object, cells_[object]);
        here_[object] = true;
    }

    bool here(std::uint32_t object) const { return here_[object]; }

    void expect_found(const Box3f& box) const {
        CellBox cells;
        octree_.space().cells(std::span(&box, 1), {&cells, 1});
        std::vector<std::uint32_t> found;
        octree_.search(cells, found);
        std::sort(found.begin(), found.end());
        ASSERT_EQ(std::adjacent_find(found.begin(), found.end()), found.end()) << "an object was found twice";
        for (std::uint32_t object = 0; object < cells_.size(); ++object) {
            const bool is_found = std::binary_search(found.begin(), found.end(), object);
            if (!here_[object]) {
                ASSERT_FALSE(is_found) << "object " << object << " is not in the octree";
            } else if (overlap(cells_[object], cells)) {
                ASSERT_TRUE(is_found) << "object " << object << " is missing";
            }
        }
    }

private:
    MutableOctree octree_;
    std::vector<CellBox> cells_;
    std::vector<bool> here_;
};

class MutableOctreeTest : public ::testing::TestWithParam<std::string> {};

TEST_P(MutableOctreeTest, FindsAllOnce) {
    for (const std::uint64_t objects : {1u, 40u, 3000u}) {
        const std::vector<Box3f> boxes = make_boxes(GetParam(), objects, 7);
        const std::vector<Box3f> others = make_boxes(GetParam(), objects, 8);
        Changing octree(boxes);
        for (std::size_t i = 0; i < boxes.size(); i += 1 + boxes.size() / 60) {
            octree.expect_found(boxes[i]);
            octree.expect_found(others[i]);
        }
    }
}

TEST_P(MutableOctreeTest, FindsAllOnceAfterChanges) {
    constexpr std::uint32_t objects = 1500;
    const std::vector<Box3f> boxes = make_boxes(GetParam(), objects, 9);
    const std::vector<Box3f> others = make_boxes(GetParam(), objects, 10);
    Changing octree(boxes);
    std::mt19937 random(11);
    const std::uint32_t size = std::uint32_t(std::min(boxes.size(), others.size()));
    for (int round = 0; round < 4000; ++round) {
        const std::uint32_t object = std::uint32_t(random() % size);
        octree.here(object) ? octree.erase(object) : octree.insert(object, others[random() % size]);
    }
    for (std::uint32_t i = 0; i < size; i += 30) {
        octree.expect_found(boxes[i]);
        octree.expect_found(others[i]);
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds, MutableOctreeTest, ::testing::ValuesIn(all_kind_names()), param_name);

/// Accepts every object.
class TakeAll {
public:
    double at_least(const Box3d&) const { return 0; }
    double limit() const { return 0; }
    CellBox reach() const { return all_cells; }
    void take(std::uint32_t object) { taken.push_back(object); }

    std::vector<std::uint32_t> taken;
};

TEST(MutableOctreeTest, AnEmptyOneFindsNothing) {
    MutableOctree octree;
    std::vector<std::uint32_t> found;
    octree.search({}, found);
    EXPECT_TRUE(found.empty());
    TakeAll visitor;
    NearestSearch(octree, RegionMap(octree.space(), {}), {}, visitor).run();
    EXPECT_TRUE(visitor.taken.empty());
}

/// Builds `octree` and requests a stop after `delay`, or before the build if `delay` is 0. Returns whether the build
/// was cancelled.
bool stopped_after(std::chrono::nanoseconds delay, const Linear& linear, MutableOctree& octree) {
    std::stop_source stop;
    if (delay.count() == 0) stop.request_stop();
    std::jthread clock([&, until = std::chrono::steady_clock::now() + delay] {
        std::this_thread::sleep_until(until);
        stop.request_stop();
    });
    try {
        build(octree, linear, stop.get_token());
        return false;
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::cancelled);
        return true;
    }
}

TEST(MutableOctreeTest, AStoppedBuildLeavesNothing) {
    constexpr unsigned moments = 12;
    const std::vector<Box3f> boxes = make_boxes("uniform", 50'000, 1);
    const Linear linear(boxes);
    MutableOctree octree;
    const auto begin = std::chrono::steady_clock::now();
    build(octree, linear);
    const auto whole = std::chrono::steady_clock::now() - begin;
    std::vector<CellBox> cells(boxes.size());
    octree.space().cells(boxes, cells);
    unsigned cancelled = 0;
    // The moments range from the start of the build to about its end.
    for (unsigned moment = 0; moment < moments; ++moment) {
        if (!stopped_after(whole * moment / moments, linear, octree)) continue;
        ++cancelled;
        std::vector<std::uint32_t> found;
        for (const CellBox& box : cells) octree.search(box, found);
        EXPECT_TRUE(found.empty()) << "stopped at moment " << moment << " of " << moments;
    }
    EXPECT_GT(cancelled, 0u);
}

}  // namespace
}  // namespace octopair::test
