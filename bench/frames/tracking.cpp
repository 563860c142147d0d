#include "frames/tracking.hpp"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "frames/motion.hpp"
#include "samples/scenes.hpp"

namespace octopair::bench {

namespace {

struct Runner {
    Track track;
    std::unique_ptr<Tracker> tracker;
    double spent = 0;
};

struct Times {
    double wall = 0, processor = 0;
};

double processor_now() {
    timespec time{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

template <typename Body>
Times timed(const Body& body) {
    const double processor = processor_now();
    const auto begin = std::chrono::steady_clock::now();
    body();
    const auto end = std::chrono::steady_clock::now();
    return {std::chrono::duration<double>(end - begin).count(), processor_now() - processor};
}

std::vector<Runner> make_runners(const FrameCase& which) {
    const std::vector<TrackerKind> kinds = tracker_kinds();
    std::vector<Runner> runners;
    runners.reserve(which.trackers.size());
    for (const std::string& name : which.trackers) {
        const auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const auto& one) { return one.name == name; });
        if (kind == kinds.end()) throw std::out_of_range("no tracker " + name);
        Runner& runner = runners.emplace_back();
        runner.track.tracker = name;
        runner.tracker = kind->make(which.threads);
    }
    return runners;
}

/// Compares the pairs of all runners with the pairs of the first runner.
void judge(std::vector<Runner>& runners) {
    const Found expected = runners.front().tracker->found();
    for (Runner& runner : runners) {
        if (!runner.tracker) continue;
        const Found found = runner.tracker->found();
        runner.track.pairs = found.pairs;
        if (found == expected || (found.hash == 0 && found.pairs == expected.pairs)) continue;
        if (runner.track.differing++ == 0) runner.track.differs_pairs = found.pairs;
    }
}

void run_frame(std::vector<Runner>& runners, const Frame& frame) {
    for (Runner& runner : runners) {
        if (!runner.tracker) continue;
        const Times times = timed([&] { runner.tracker->next(frame); });
        runner.track.seconds.push_back(times.wall);
        runner.track.processor_seconds.push_back(times.processor);
        runner.spent += times.wall;
    }
}

/// Finds with each tracker the objects that overlap some boxes, other boxes in each frame. Compares their numbers.
void run_queries(std::vector<Runner>& runners, const FrameCase& which, std::span<const Box3f> boxes, unsigned frame) {
    std::vector<Box3f> asked(which.queries);
    for (std::size_t i = 0; i < asked.size(); ++i) asked[i] = boxes[(frame + 37 * i) % boxes.size()];
    std::optional<std::uint64_t> expected;
    for (Runner& runner : runners) {
        if (!runner.tracker || asked.empty()) continue;
        std::optional<std::uint64_t> objects;
        const Times times = timed([&] { objects = runner.tracker->overlaps(asked); });
        if (!objects) continue;
        runner.track.query_seconds.push_back(times.wall / double(asked.size()));
        if (!expected) expected = objects;
        if (*objects != *expected) ++runner.track.differing_queries;
    }
}

/// Stops slow trackers. A tracker that missed a frame cannot continue. The first tracker is the reference and always
/// stays.
void end_slow(std::vector<Runner>& runners, const FramePlan& plan) {
    for (std::size_t i = 1; i < runners.size(); ++i) {
        Runner& runner = runners[i];
        if (runner.spent > plan.max_seconds && runner.track.seconds.size() >= plan.min_frames) {
            runner.tracker.reset();
        }
    }
}

/// Requires: there are values.
double quantile_of(std::vector<double> values, double share) {
    std::sort(values.begin(), values.end());
    const auto rank = std::size_t(std::ceil(share * double(values.size())));
    return values[std::clamp<std::size_t>(rank, 1, values.size()) - 1];
}

}  // namespace

unsigned frames_of(const FrameCase& which, const FramePlan& plan) { return plan.frames * which.frames_factor; }

double Track::quantile(double share, Clock clock) const {
    const std::vector<double>& of = clock == Clock::wall ? seconds : processor_seconds;
    return of.empty() ? first_seconds : quantile_of(of, share);
}

double Track::query_quantile(double share) const { return quantile_of(query_seconds, share); }

std::vector<Track> track(const FrameCase& which, const FramePlan& plan, const TrackingProgress& progress) {
    Motion motion(samples::make_scene("uniform", which.objects, 1), which.share);
    std::vector<Runner> runners = make_runners(which);
    for (Runner& runner : runners) {
        runner.track.first_seconds = timed([&] { runner.tracker->begin(motion.boxes()); }).wall;
        progress(fmt::format("first frame of {}: {:.2f} ms", runner.track.tracker, runner.track.first_seconds * 1e3));
    }
    judge(runners);
    const unsigned frames = frames_of(which, plan);
    for (unsigned i = 0; i < frames; ++i) {
        run_frame(runners, motion.next());
        judge(runners);
        run_queries(runners, which, motion.boxes(), i);
        end_slow(runners, plan);
        if ((i + 1) % (frames / 10 + 1) == 0) progress(fmt::format("frame {} of {}", i + 1, frames));
    }
    std::vector<Track> tracks;
    tracks.reserve(runners.size());
    for (Runner& runner : runners) tracks.push_back(std::move(runner.track));
    return tracks;
}

}  // namespace octopair::bench
