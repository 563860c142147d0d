// LiveFeed: pages that apply whole frames and differences have the true boxes and pairs after every frame.
#include <gtest/gtest.h>

#include <set>
#include <thread>

#include "viewer/live/live_feed.hpp"
#include "viewer/live_page.hpp"
#include "viewer/scene/frame_answers.hpp"
#include "viewer/shown_frames.hpp"

namespace octopair::test {

namespace {

using viewer::LiveFeed;
using viewer::LiveState;

/// A scene that changes at random, and its true pairs.
class ChangingScene {
public:
    ChangingScene(Random& random, std::size_t count)
        : random_(random), boxes_(random_boxes(random, count)), exists_(count, 1) {
        pairs_ = true_pairs(boxes_, exists_);
    }

    /// Changes some objects. Records the events of the pairs.
    void step() {
        const std::vector<Pair> before = pairs_;
        const std::size_t changes = random_() % 3 == 0 ? 0 : random_() % (boxes_.size() / 4 + 1);
        for (std::size_t i = 0; i < changes; ++i) change(random_() % boxes_.size());
        pairs_ = true_pairs(boxes_, exists_);
        std::vector<Pair> began, ended;
        std::set_difference(pairs_.begin(), pairs_.end(), before.begin(), before.end(), std::back_inserter(began));
        std::set_difference(before.begin(), before.end(), pairs_.begin(), pairs_.end(), std::back_inserter(ended));
        for (const Pair pair : ended) events_.push_back({pair, false});
        for (const Pair pair : began) events_.push_back({pair, true});
        ++steps_;
    }
    void add() {
        boxes_.push_back(random_boxes(random_, 1)[0]);
        exists_.push_back(1);
        const std::vector<Pair> before = pairs_;
        pairs_ = true_pairs(boxes_, exists_);
        for (const Pair pair : pairs_) {
            if (!std::binary_search(before.begin(), before.end(), pair)) events_.push_back({pair, true});
        }
    }

    /// Returns the state for the feed. `all_pairs`: with all pairs in place of events.
    LiveState state(bool all_pairs) {
        LiveState state;
        if (random_() % 2 == 0) {
            state.boxes = boxes_;
        } else {
            std::vector<Box3f> narrow;
            for (const Box3d& box : boxes_) {
                narrow.push_back({{float(box.min[0]), float(box.min[1]), float(box.min[2])},
                                  {float(box.max[0]), float(box.max[1]), float(box.max[2])}});
            }
            state.boxes = narrow;
        }
        const bool all_exist = std::count(exists_.begin(), exists_.end(), 0) == 0;
        if (!all_exist || random_() % 2 == 0) state.exists = exists_;
        if (all_pairs) state.pairs = pairs_;
        if (!all_pairs) state.events = events_;
        events_.clear();
        state.pair_count = pairs_.size();
        state.step = steps_;
        state.step_seconds = 0.25;
        return state;
    }

    void expect_shown_by(const LivePage& page, const Point3d& origin, std::size_t most_shown) const {
        EXPECT_EQ(page.objects, boxes_.size());
        ASSERT_EQ(page.rows.size(), std::min(boxes_.size(), most_shown));
        EXPECT_EQ(page.shown_objects.size(), boxes_.size() > most_shown ? most_shown : 0);
        for (std::size_t row = 0; row < page.rows.size(); ++row) {
            ASSERT_TRUE(page.shown_objects.empty() || page.shown_objects[row] == row);
            ASSERT_EQ(page.rows[row].is_absent(), exists_[row] == 0) << row;
            if (exists_[row] == 0) continue;
            for (std::size_t i = 0; i < 3; ++i) {
                ASSERT_EQ(page.rows[row].ends[i], float(boxes_[row].min[i] - origin[i])) << row;
                ASSERT_EQ(page.rows[row].ends[i + 3], float(boxes_[row].max[i] - origin[i])) << row;
            }
        }
        EXPECT_EQ(page.pair_count, pairs_.size());
        ASSERT_EQ(page.pairs, std::set<Pair>(pairs_.begin(), pairs_.end()));
        EXPECT_EQ(page.microseconds, 250'000u);
    }

private:
    void change(std::size_t object) {
        const unsigned what = unsigned(random_() % 10);
        if (what == 0) {
            exists_[object] = 0;
        } else if (what == 1) {
            exists_[object] = 1;
        } else if (what < 9) {
            boxes_[object] = random_boxes(random_, 1, 0.02)[0];
        }
    }

    Random& random_;
    std::vector<Box3d> boxes_;
    std::vector<std::uint8_t> exists_;
    std::vector<Pair> pairs_;
    std::vector<LiveState::PairEvent> events_;
    std::uint64_t steps_ = 0;
};

/// Gives a page the newest frame, if it has another one.
void refresh(LivePage& page, LiveFeed& feed) {
    const auto message = feed.frame_after(page.frame);
    if (message != nullptr) page.apply(*message);
}

void run_random_feed(std::uint64_t seed, std::size_t most_shown) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    ChangingScene scene(random, 1 + random() % 60);
    LiveFeed feed(most_shown);
    feed.put(scene.state(true));
    std::vector<LivePage> pages(5);
    for (int step = 0; step < 120; ++step) {
        for (std::uint64_t skipped = random() % 3; skipped > 0; --skipped) scene.step();  // frames that are dropped
        if (random() % 30 == 0) scene.add();
        feed.put(scene.state(random() % 20 == 0));
        for (std::size_t i = 0; i < pages.size(); ++i) {
            if (random() % (2 * i + 1) != 0) continue;
            refresh(pages[i], feed);
            scene.expect_shown_by(pages[i], feed.origin(), most_shown);
            if (testing::Test::HasFatalFailure()) return;
            EXPECT_EQ(feed.frame_after(pages[i].frame), nullptr);
        }
        if (random() % 40 == 0) pages[random() % pages.size()] = {};  // a page that is opened again
    }
}

TEST(LiveFeed, PagesHaveTheTrueBoxesAndPairs) {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        run_random_feed(seed, 1000);
        if (HasFailure()) return;
    }
}

TEST(LiveFeed, OfMoreObjectsThanAreShown) {
    for (std::uint64_t seed = 1000; seed < 1040; ++seed) {
        run_random_feed(seed, 1 + seed % 13);
        if (HasFailure()) return;
    }
}

LiveState state_of(const std::vector<Box3d>& boxes, std::vector<LiveState::PairEvent> events, std::uint64_t pairs) {
    LiveState state;
    state.boxes = boxes;
    state.events = std::move(events);
    state.pair_count = pairs;
    return state;
}

const std::vector<Box3d> three_boxes(3, Box3d{{0, 0, 0}, {1, 1, 1}});

TEST(LiveFeed, BeforeTheFirstFrame) {
    LiveFeed feed;
    EXPECT_EQ(feed.frame_after(-1), nullptr);
    EXPECT_EQ(feed.frame_after(5), nullptr);
    EXPECT_TRUE(feed.latest().data.pairs.empty());
    EXPECT_EQ(feed.origin(), Point3d{});
}

TEST(LiveFeed, EventsThatCancelOut) {
    LiveFeed feed;
    LiveState first = state_of(three_boxes, {}, 1);
    first.pairs = std::vector<Pair>{{0, 1}};
    feed.put(std::move(first));
    LivePage page, late;
    refresh(page, feed);
    refresh(late, feed);
    // Within one state.
    feed.put(state_of(three_boxes, {{{0, 1}, false}, {{0, 2}, true}, {{0, 1}, true}, {{0, 2}, false}}, 1));
    refresh(page, feed);
    EXPECT_EQ(page.changed_pairs, 0u);
    EXPECT_EQ(page.pairs, (std::set<Pair>{{0, 1}}));
    // Across states, for a page that misses the state between.
    feed.put(state_of(three_boxes, {{{0, 1}, false}, {{0, 2}, true}}, 1));
    refresh(page, feed);
    EXPECT_EQ(page.pairs, (std::set<Pair>{{0, 2}}));
    feed.put(state_of(three_boxes, {{{0, 2}, false}, {{0, 1}, true}}, 1));
    refresh(late, feed);
    EXPECT_FALSE(late.is_whole);
    EXPECT_EQ(late.changed_pairs, 0u);
    EXPECT_EQ(late.pairs, (std::set<Pair>{{0, 1}}));
    refresh(page, feed);
    EXPECT_EQ(page.pairs, late.pairs);
}

TEST(LiveFeed, RepeatedEventsCountOnce) {
    LiveFeed feed;
    LiveState first = state_of(three_boxes, {}, 1);
    first.pairs = std::vector<Pair>{{0, 1}};
    feed.put(std::move(first));
    LivePage page;
    refresh(page, feed);
    feed.put(state_of(three_boxes, {{{0, 1}, true}, {{1, 2}, true}, {{1, 2}, true}, {{0, 2}, false}}, 2));
    refresh(page, feed);
    EXPECT_EQ(page.pairs, (std::set<Pair>{{0, 1}, {1, 2}}));
    EXPECT_EQ(page.changed_pairs, 1u);
}

TEST(LiveFeed, FramesThatDoNotExist) {
    LiveFeed feed;
    feed.put(state_of(three_boxes, {}, 0));
    for (const std::int64_t last :
         {std::int64_t(-1), std::int64_t(-7), std::int64_t(1), std::int64_t(1) << 40,
          std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max()}) {
        const auto message = feed.frame_after(last);
        ASSERT_NE(message, nullptr) << last;
        LivePage page;
        page.apply(*message);
        EXPECT_TRUE(page.is_whole);
    }
    EXPECT_EQ(feed.frame_after(0), nullptr);
}

TEST(LiveFeed, ALongTimeApartComesAWholeFrame) {
    Random random(11);
    ChangingScene scene(random, 20);
    LiveFeed feed;
    feed.put(scene.state(true));
    LivePage near, far;
    refresh(near, feed);
    refresh(far, feed);
    for (int i = 0; i < 256; ++i) {
        scene.step();
        feed.put(scene.state(false));
    }
    refresh(near, feed);  // a difference, or a whole frame if that is shorter
    scene.expect_shown_by(near, feed.origin(), 1000);
    scene.step();
    feed.put(scene.state(false));
    refresh(far, feed);
    EXPECT_TRUE(far.is_whole);
    scene.expect_shown_by(far, feed.origin(), 1000);
}

TEST(LiveFeed, TheOriginIsThatOfTheFirstObjects) {
    LiveFeed feed;
    feed.put(state_of({}, {}, 0));
    LivePage page;
    refresh(page, feed);
    const std::vector<Box3d> boxes = {{{4e6, 4e6, 4e6}, {4e6 + 0.125, 4e6 + 0.25, 4e6 + 0.5}}};
    feed.put(state_of(boxes, {}, 1));
    refresh(page, feed);
    EXPECT_TRUE(page.is_whole);
    EXPECT_NEAR(feed.origin()[0], 4e6, 1);
    const viewer::RelativeBox expected = viewer::relative(boxes[0], feed.origin());
    EXPECT_EQ(page.rows.at(0).ends[0], expected.ends[0]);
    EXPECT_EQ(page.rows.at(0).ends[5], expected.ends[5]);
    EXPECT_EQ(expected.ends[3] - expected.ends[0], 0.125F);
}

TEST(LiveFeed, MorePairsThanListed) {
    constexpr std::uint32_t objects = 1000;  // 499,500 pairs
    const std::vector<Box3d> boxes(objects, Box3d{{0, 0, 0}, {1, 1, 1}});
    LiveState first = state_of(boxes, {}, 0);
    first.pairs = true_pairs(boxes);
    first.pair_count = first.pairs->size();
    const std::uint64_t all = first.pair_count;
    LiveFeed feed;
    feed.put(std::move(first));
    LivePage page;
    refresh(page, feed);
    EXPECT_EQ(page.pairs.size(), viewer::max_listed_pairs);
    EXPECT_EQ(page.pair_count, all);
    EXPECT_FALSE(page.lists_all);
    feed.put(state_of(boxes, {{{0, 1}, false}, {{998, 999}, false}}, all - 2));
    refresh(page, feed);
    EXPECT_EQ(page.pair_count, all - 2);
}

TEST(LiveFeed, TooManyPairsToKeep) {
    // The scene has so many pairs that no state brings them: the feed has the number alone.
    LiveFeed feed;
    LiveState first = state_of(three_boxes, {}, std::uint64_t(5) << 32);
    first.pairs.emplace();
    feed.put(std::move(first));
    LivePage page;
    refresh(page, feed);
    EXPECT_EQ(page.pair_count, std::uint64_t(5) << 32);
    EXPECT_FALSE(page.lists_all);
    feed.put(state_of(three_boxes, {}, std::uint64_t(6) << 32));
    refresh(page, feed);
    EXPECT_EQ(page.pair_count, std::uint64_t(6) << 32);
}

TEST(LiveFeed, AnUnchangedSceneCostsTheHeaderAlone) {
    LiveFeed feed;
    feed.put(state_of(three_boxes, {}, 0));
    LivePage page;
    refresh(page, feed);
    feed.put(state_of(three_boxes, {}, 0));
    refresh(page, feed);
    EXPECT_EQ(page.last_bytes, 64u);
    EXPECT_EQ(page.frame, 1);
}

TEST(LiveFeed, OfNoObjects) {
    LiveFeed feed;
    feed.put(state_of({}, {}, 0));
    LivePage page;
    refresh(page, feed);
    EXPECT_EQ(page.objects, 0u);
    feed.put(state_of(three_boxes, {{{0, 1}, true}}, 1));
    refresh(page, feed);
    EXPECT_TRUE(page.is_whole);
    EXPECT_EQ(page.rows.size(), 3u);
    EXPECT_EQ(page.pairs.size(), 1u);
    feed.put(state_of({}, {{{0, 1}, false}}, 0));
    refresh(page, feed);
    EXPECT_EQ(page.rows.size(), 0u);
}

TEST(LiveFeed, ReadersOnOtherThreads) {
    Random random(12);
    ChangingScene scene(random, 40);
    LiveFeed feed;
    feed.put(scene.state(true));
    std::atomic<bool> done = false;
    std::vector<LivePage> pages(3);
    std::vector<std::thread> readers;
    for (LivePage& page : pages) {
        readers.emplace_back([&feed, &done, &page] {
            while (!done) {
                refresh(page, feed);
                (void)feed.latest().data.pairs.size();
            }
        });
    }
    for (int i = 0; i < 300; ++i) {
        scene.step();
        feed.put(scene.state(i % 50 == 0));
    }
    done = true;
    for (std::thread& reader : readers) reader.join();
    for (LivePage& page : pages) {
        refresh(page, feed);
        scene.expect_shown_by(page, feed.origin(), 1000);
    }
}

}  // namespace

}  // namespace octopair::test
