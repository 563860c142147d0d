// FakeFinder: a scene in memory for tests of FrameSource, whose pairs are found by brute force; and readers of its answers.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <iterator>
#include <new>
#include <string>
#include <thread>
#include <vector>

#include "octopair/error.hpp"
#include "viewer/scene/frame_source.hpp"
#include "viewer/shown_frames.hpp"

namespace octopair::test {

using viewer::Address;
using viewer::FrameSource;
using viewer::SceneContents;

/// Finds the pairs of frames in memory by brute force. Fails if two threads use it at once.
class FakeFinder final : public viewer::FrameFinder {
public:
    FakeFinder(std::uint64_t seed, std::uint64_t frames, std::size_t objects) {
        Random random(seed);
        std::vector<Box3d> boxes = random_boxes(random, objects);
        for (std::uint64_t f = 0; f < frames; ++f) {
            boxes_.push_back(boxes);
            pairs_.push_back(true_pairs(boxes));
            for (std::size_t i = 0; i < objects; i += 1 + random() % 5) boxes[i] = random_boxes(random, 1, 0.02)[0];
        }
    }

    std::uint64_t frames() const override { return boxes_.size(); }

    viewer::FrameData find(std::uint64_t frame, const ProgressSink& progress) override {
        EXPECT_FALSE(busy_.exchange(true)) << "two threads at once";
        if (progress) progress(0.5);
        std::this_thread::sleep_for(pause);
        if (frame == broken_frame) {
            busy_ = false;
            if (lacks_memory) throw std::bad_alloc();
            throw Error(ErrorCode::bad_input, "frame is broken");
        }
        viewer::FrameData data;
        data.boxes = std::span<const Box3d>(boxes_[frame]);
        data.exists = exists;
        data.pairs = pairs_[frame];
        data.pair_count = data.pairs.size();
        data.facts.push_back({"seconds.detect", seconds});
        ++finds;
        busy_ = false;
        return data;
    }

    std::vector<Pair> pairs(std::uint64_t frame) const { return pairs_[frame]; }
    std::vector<Pair> began(std::uint64_t frame) const { return missing_in(frame, frame - 1); }
    std::vector<Pair> ended(std::uint64_t frame) const {
        return frame == 0 ? std::vector<Pair>() : missing_in(frame - 1, frame);
    }

    std::chrono::milliseconds pause{0};
    double seconds = 0.5;  ///< time that each frame is said to have taken
    std::uint64_t broken_frame = ~std::uint64_t(0);
    bool lacks_memory = false;  ///< the broken frame does not fit into memory
    std::vector<std::uint8_t> exists;
    std::atomic<int> finds = 0;

private:
    /// Returns the pairs of a frame that another frame does not have.
    std::vector<Pair> missing_in(std::uint64_t frame, std::uint64_t other) const {
        std::vector<Pair> pairs, none;
        const std::vector<Pair>& known = other < pairs_.size() ? pairs_[other] : none;
        std::set_difference(pairs_[frame].begin(), pairs_[frame].end(), known.begin(), known.end(),
                            std::back_inserter(pairs));
        return pairs;
    }

    std::vector<std::vector<Box3d>> boxes_;
    std::vector<std::vector<Pair>> pairs_;
    std::atomic<bool> busy_ = false;
};

inline SceneContents contents_of(std::uint64_t objects, bool moving) {
    SceneContents contents;
    contents.title = "scene";
    contents.objects = objects;
    contents.moving = moving;
    return contents;
}

inline std::string body_of(FrameSource& source, const std::string& address) {
    const auto answer = source.get(*Address::parse('/' + address));
    return answer ? answer->body : "none";
}
inline Json json_of(FrameSource& source, const std::string& address) { return Json::parse(body_of(source, address)); }
inline std::vector<Pair> pairs_of(FrameSource& source, const std::string& address) {
    return array_of<Pair>(body_of(source, address));
}

}  // namespace octopair::test
