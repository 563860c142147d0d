// Tests searches of boxes that change between any two reads. The result is arbitrary, or an error. Memory must stay intact, which the
// address sanitizer checks, and the search must end.
#include <gtest/gtest.h>

#include <variant>
#include <vector>

#include "boxes/box_source.hpp"
#include "exactness/small_scenes.hpp"
#include "exactness/tiny_tuning.hpp"
#include "octopair/error.hpp"
#include "octree/build/linear_octree.hpp"
#include "octree/scan/scan.hpp"
#include "samples/random.hpp"
#include "support/families.hpp"
#include "support/hostile_boxes.hpp"
#include "support/kinds.hpp"
#include "support/scale.hpp"

#ifdef OCTOPAIR_TEST_HOOKS

namespace octopair::test {
namespace {

constexpr std::uint64_t usual_searches = scaled(20'000, 10);

/// The objects of a case. change() overwrites some of their boxes.
class ChangingObjects {
public:
    ChangingObjects(Case a_case, std::uint64_t seed) : case_(std::move(a_case)), random_(seed, 3) {
        hostility_ = random_.below(2) == 0 ? Hostility::valid : Hostility::any;
        change_probability_ = random_.uniform() * random_.uniform();
        for (OwnedObjects* const set : {&case_.first, case_.second ? &*case_.second : nullptr}) {
            if (set == nullptr) continue;
            std::visit(
                [&]<typename Real>(std::vector<Box<Real>>& boxes) {
                    overwriters_.emplace_back(BoxOverwriter<Real>(boxes, hostility_, random_.below(1u << 30)));
                },
                set->boxes);
        }
    }

    void change() {
        if (random_.uniform() > change_probability_) return;
        for (std::uint64_t i = 1 + random_.below(4); i > 0; --i) {
            auto& one = overwriters_[random_.below(overwriters_.size())];
            std::visit([](auto& overwriter) { overwriter.overwrite_one(); }, one);
        }
    }
    const Case& a_case() const { return case_; }

private:
    Case case_;
    samples::RandomStream random_;
    Hostility hostility_;
    double change_probability_;  // that boxes change before a read
    std::vector<std::variant<BoxOverwriter<float>, BoxOverwriter<double>>> overwriters_;
};

/// A source whose boxes change before each read.
class ChangingSource final : public ForwardingSource {
public:
    ChangingSource(ChangingObjects& objects, const BoxSource& boxes) : ForwardingSource(boxes), objects_(objects) {}

    bool load(std::size_t begin, std::span<Entry> out) const override { return changed().load(begin, out); }
    Float32Boxes float32_boxes(std::size_t begin, std::span<Box3f> room) const override {
        return changed().float32_boxes(begin, room);
    }
    void pick(std::span<const std::size_t> positions, std::span<Entry> out) const override {
        changed().pick(positions, out);
    }
    bool is_pair(std::uint32_t a, std::uint32_t b) const override { return changed().is_pair(a, b); }
    std::size_t refused(const DoubtfulPairs& doubtful, std::uint32_t* out) const override {
        return changed().refused(doubtful, out);
    }
    void load_bounds(std::span<Entry> entries) const override { changed().load_bounds(entries); }

private:
    const EntrySource& changed() const {
        objects_.change();
        return source();
    }

    ChangingObjects& objects_;
};

class Collector final : public ShareWriter {
public:
    bool counting() const override { return false; }
    void write(std::span<const Pair> pairs) override { found.insert(found.end(), pairs.begin(), pairs.end()); }
    void write_count(std::uint64_t) override { FAIL() << "expected pairs, not a number of pairs"; }

    std::vector<Pair> found;
};

/// Runs shares one after the other. Boxes change before each.
class ChangingExecutor final : public Executor {
public:
    ChangingExecutor(ChangingObjects& objects, ShareWriter& writer) : objects_(objects), writer_(writer) {}
    unsigned width() const override { return 3; }
    void for_each(std::size_t count, const std::function<void(std::size_t)>& body) override {
        for (std::size_t i = 0; i < count; ++i) {
            objects_.change();
            body(i);
        }
    }
    void for_each_writing(std::size_t count, const std::function<void(std::size_t, ShareWriter&)>& body) override {
        for_each(count, [&](std::size_t i) { body(i, writer_); });
    }

private:
    ChangingObjects& objects_;
    ShareWriter& writer_;
};

enum class End : std::uint8_t { found, refused_by_build, refused };

/// Searches, and checks the numbers of the objects that are found.
End search(ChangingObjects& objects) {
    const Case& a_case = objects.a_case();
    const Objects first = a_case.first.view(), second = a_case.second ? a_case.second->view() : Objects{};
    const BoxSource boxes(first, a_case.second ? &second : nullptr, a_case.margin);
    const ChangingSource source(objects, boxes);
    Collector collector;
    ChangingExecutor executor(objects, collector);
    ScanMemoryPool memory;
    LinearOctree octree;
    try {
        octree.build(source, executor, {});
        scan(octree, {source, {}, memory}, executor, {});
    } catch (const LinearOctree::Invalid&) {
        return End::refused_by_build;
    } catch (const Error& error) {
        EXPECT_TRUE(error.code() == ErrorCode::bad_input || error.code() == ErrorCode::engine_failed) << error.what();
        return End::refused;
    }
    const std::uint64_t columns = a_case.second ? second.size() : first.size();
    for (const Pair& pair : collector.found) {
        EXPECT_LT(pair.a, first.size());
        EXPECT_LT(pair.b, columns);
    }
    return End::found;
}

TEST(ChangingBoxes, DamageNoMemory) {
    std::array<std::uint64_t, 3> ends{};
    const std::uint64_t searches = case_count(usual_searches);
    for (std::uint64_t i = 0; i < searches; ++i) {
        const std::uint64_t seed = case_seed("changing boxes", i);
        SCOPED_TRACE("OCTOPAIR_TEST_SEED=" + std::to_string(seed));
        const TuningScope tiny(tiny_tuning(seed));
        ChangingObjects objects(small_case(seed), seed);
        ++ends[std::size_t(search(objects))];
        if (HasFailure()) return;
    }
    if (searches < usual_searches) return;
    for (const std::uint64_t end : ends) EXPECT_GT(end, searches / 50);
    using enum Path;
    EXPECT_EQ(paths_not_taken({build_blocks, scattered_twice, kept_above_leaf, ghosts_by_rule, handed_down, crowd_whole,
                               crowd_parted, part_recursive, nested_twice, nested_join, tiles, recursion_spanning,
                               recursion_halved, sort_buckets, sort_radix, cell_hit_refused, hit_turned, hit_settled}),
              "");
}

}  // namespace
}  // namespace octopair::test

#endif
