// Tests the memory of a scene: no heap allocations in steady frames, and a bounded size for its content.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>

#include "octopair/octopair.hpp"
#include "samples/scenes.hpp"
#include "support/peak_memory.hpp"
#include "support/scale.hpp"

namespace {

std::atomic<std::uint64_t> allocations = 0;
std::atomic<std::uint64_t> refused = ~std::uint64_t(0);  // index of the allocation that fails

}  // namespace

#ifndef OCTOPAIR_TEST_SANITIZED
// These functions replace those of the C library. So every allocation of this process is counted, also those of Buffer
// and operator new. Large allocations come from mmap; tests find them in the resident memory.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void* malloc(std::size_t size) { return allocations++ == refused ? nullptr : __libc_malloc(size); }
void* aligned_alloc(std::size_t alignment, std::size_t size) {
    return allocations++ == refused ? nullptr : __libc_memalign(alignment, size);
}
}
#endif

namespace octopair::test {
namespace {

/// Objects that swing between two places, a few in each frame.
class Swing {
public:
    Swing(std::uint64_t objects, unsigned threads)
        : scene(SceneOptions{threads}), boxes_(samples::make_scene("uniform", objects, 1)), ids_(objects) {
        scene.add(Objects{boxes_}, ids_);
    }

    void frame(std::uint64_t begin, std::uint64_t count) {
        for (std::uint64_t i = begin; i < begin + count; ++i) {
            Box3f& box = boxes_[i];
            const float way = (box.max[0] - box.min[0]) * ((frames_ + i) % 2 == 0 ? 0.5f : -0.5f);
            box.min[0] += way;
            box.max[0] += way;
        }
        ++frames_;
        scene.move(std::span(ids_).subspan(begin, count), std::span<const Box3f>(boxes_).subspan(begin, count));
        const StepResult& result = scene.step();
        changes += result.began.size() + result.ended.size();
        full += result.full ? 1 : 0;
        pairs = scene.pairs().size();
    }

    Scene scene;
    std::uint64_t changes = 0, full = 0, pairs = 0;

private:
    std::vector<Box3f> boxes_;
    std::vector<ObjectId> ids_;
    std::uint64_t frames_ = 0;
};

TEST(SteadyScene, TakesNothingFromTheHeap) {
#ifdef OCTOPAIR_TEST_SANITIZED
    GTEST_SKIP() << "the sanitizer replaces malloc";
#endif
    constexpr std::uint64_t objects = 30'000;
    Swing swing(objects, 1);
    const auto frames = [&](int count) {
        for (int i = 0; i < count; ++i) swing.frame(std::uint64_t(i / 2 % 20) * 300, 300);
    };
    frames(80);
    const std::uint64_t before = allocations, changes = swing.changes, full = swing.full, peak = peak_rss();
    frames(80);
    EXPECT_EQ(allocations - before, 0u);
    EXPECT_LE(peak_rss() - peak, 64u << 10);
    EXPECT_GT(swing.changes, changes);
    EXPECT_EQ(swing.full, full);
}

/// Any allocation of a step may fail: the step throws, and a repeated step finds the same result.
TEST(SceneMemory, AStepThatRunsOutOfItMayBeRepeated) {
#ifdef OCTOPAIR_TEST_SANITIZED
    GTEST_SKIP() << "the sanitizer replaces malloc";
#endif
    constexpr std::uint64_t objects = 3000;
    for (const std::uint64_t moved : {std::uint64_t(100), objects}) {
        std::uint64_t failures = 0;
        bool whole = false;
        for (std::uint64_t n = 0; !whole && n < 4000; n += 1 + n / 40) {
            auto boxes = samples::make_scene("dense", objects, 1);
            std::vector<ObjectId> ids(objects);
            Scene scene({1});
            scene.add(Objects{boxes}, ids);
            const std::uint64_t before = scene.step().pairs();
            for (std::uint64_t i = 0; i < moved; ++i) boxes[i] = boxes[objects - 1 - i];
            scene.move(std::span(ids).first(moved), std::span<const Box3f>(boxes).first(moved));
            const std::uint64_t after = find_pairs(boxes).size();
            whole = true;
            refused = allocations + n;
            try {
                EXPECT_EQ(scene.step().full, moved == objects);
            } catch (const Error& error) {
                whole = false;
                refused = ~std::uint64_t(0);
                ASSERT_EQ(error.code(), ErrorCode::resource_limit);
                ASSERT_EQ(scene.pairs().size(), before);
                ++failures;
                const StepResult& again = scene.step();
                ASSERT_EQ(again.pairs(), after);
                ASSERT_EQ(before + again.began.size() - again.ended.size(), after);
            }
            refused = ~std::uint64_t(0);
            ASSERT_EQ(scene.pairs().size(), after);
        }
        EXPECT_GT(failures, 3u);
    }
}

TEST(SceneMemory, IsBounded) {
    constexpr std::uint64_t objects = scaled(1'000'000, 20);
    const auto boxes = samples::make_scene("uniform", objects, 1);
    std::vector<ObjectId> ids(objects, ObjectId{0, 0});
    const std::uint64_t before = peak_rss();
    Scene scene({2});
    scene.add(Objects{boxes}, ids);
    const std::uint64_t pairs = scene.step().pairs();
    scene.move(std::span(ids).first(100), std::span<const Box3f>(boxes).first(100));
    EXPECT_FALSE(scene.step().full);
    const double bytes = double(peak_rss() - before);
    RecordProperty("bytes_per_object", std::to_string(bytes / double(objects)));
    if (!sanitized) {
        EXPECT_LE(bytes, 120 * double(objects) + 16 * double(pairs));
    }
}

}  // namespace
}  // namespace octopair::test
