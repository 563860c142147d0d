#include "paper/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <span>

#include "base/stop.hpp"
#include "baselines/baselines.hpp"
#include "machine/median.hpp"
#include "octopair/engine.hpp"
#include "octopair/error.hpp"
#include "samples/scenes.hpp"

namespace octopair::paper {

namespace {

using Clock = std::chrono::steady_clock;
using baselines::PaperSettings;
using baselines::PaperSort;

constexpr unsigned min_rounds = 3;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

struct Outcome {
    Run run;
    std::uint64_t pairs;
};

/// One setup, ready to run.
class Runner {
public:
    Runner() = default;
    Runner(const Runner&) = delete;
    Runner& operator=(const Runner&) = delete;
    virtual ~Runner() = default;
    /// `level`: depth of the paper's octree.
    virtual Outcome run(std::span<const Box3f> boxes, unsigned level) = 0;
};

class PaperRunner final : public Runner {
public:
    explicit PaperRunner(const PaperSettings& settings) : settings_(settings) {}

    Outcome run(std::span<const Box3f> boxes, unsigned level) override {
        settings_.level = level;
        const auto start = Clock::now();
        const baselines::PaperResult result = baselines::paper_pairs(boxes, settings_);
        const double seconds = seconds_since(start);
        const baselines::PaperSeconds& steps = result.seconds;
        return {{seconds, {steps.octal_codes, steps.sort, steps.merge_machine, steps.merge_master, steps.scan}},
                result.pairs.size()};
    }

private:
    PaperSettings settings_;
};

/// Finds pairs in octal order, into a reused list.
class OctopairRunner final : public Runner {
public:
    OctopairRunner(unsigned threads, std::stop_token stop)
        : engine_(make_local_engine(threads)), stop_(std::move(stop)) {
        options_.order = Order::octal;
    }

    Outcome run(std::span<const Box3f> boxes, unsigned) override {
        const auto start = Clock::now();
        const Summary summary = engine_->find_pairs(Objects{boxes}, pairs_, options_, stop_);
        const double seconds = seconds_since(start);
        const StepSeconds& steps = summary.steps;
        return {{seconds, {steps.encode, steps.scatter, steps.count, 0, steps.scan}}, summary.pairs};
    }

private:
    std::unique_ptr<Engine> engine_;
    std::stop_token stop_;
    Options options_;
    PairList pairs_;
};

PaperSettings settings_of(const Setup& setup) {
    const PaperSort sort = setup.finder == Finder::paper ? PaperSort::radix : PaperSort::standard;
    return {0, setup.machines, setup.processors_per_machine, sort};
}

std::unique_ptr<Runner> make_runner(const Setup& setup, const std::stop_token& stop) {
    if (setup.finder == Finder::octopair) return std::make_unique<OctopairRunner>(setup.processors(), stop);
    return std::make_unique<PaperRunner>(settings_of(setup));
}

class Measurement {
public:
    Measurement(const StudyPlan& plan, const StudyProgress& progress, std::stop_token stop)
        : progress_(progress), stop_(std::move(stop)), study_{plan, {}} {
        for (const Setup& setup : setups(plan.threads)) {
            study_.series.push_back({setup, {}});
            runners_.push_back(make_runner(setup, stop_));
        }
        for (const std::uint64_t objects : plan.objects) total_ += double(objects) * (plan.rounds + 1);
    }

    Study run() {
        for (const std::uint64_t objects : study_.plan.objects) {
            say(fmt::format("{} objects: making the scene", objects));
            const std::vector<Box3f> boxes = make_boxes(objects);
            say(fmt::format("{} objects: searching for the best depth of the paper's octree", objects));
            const PaperSettings most{0, 1, study_.plan.threads, PaperSort::radix};
            measure(boxes, baselines::best_paper_level(boxes, most, stop_));
        }
        return std::move(study_);
    }

private:
    std::vector<Box3f> make_boxes(std::uint64_t objects) const {
        std::vector<Box3f> boxes;
        boxes.reserve(objects);
        samples::generate_scene({study_.plan.scene, objects, 1, 1}, [&](std::span<const Box3f> batch) {
            throw_if_stopped(stop_);
            boxes.insert(boxes.end(), batch.begin(), batch.end());
        });
        return boxes;
    }

    void measure(std::span<const Box3f> boxes, unsigned level) {
        for (Series& series : study_.series) {
            if (!takes_part(series.setup, boxes.size())) continue;
            series.points.push_back({boxes.size(), 0, series.setup.finder == Finder::octopair ? 0 : level, {}});
        }
        for (unsigned round = 0; round <= study_.plan.rounds; ++round) {
            for (std::size_t i = 0; i < study_.series.size(); ++i) turn(i, boxes, {level, round});
            done_ += double(boxes.size());
        }
    }

    struct Turn {
        unsigned level;
        unsigned round;  // round 0 is not counted
    };

    void turn(std::size_t i, std::span<const Box3f> boxes, const Turn& turn) {
        Series& series = study_.series[i];
        if (!takes_part(series.setup, boxes.size()) || rests(series.points.back(), turn.round)) return;
        throw_if_stopped(stop_);
        say(fmt::format("{} objects: {} on {}", boxes.size(), finder_text(series.setup.finder),
                        processors_text(series.setup)));
        const Outcome outcome = runners_[i]->run(boxes, turn.level);
        Point& point = series.points.back();
        point.pairs = outcome.pairs;
        if (turn.round > 0) point.runs.push_back(outcome.run);
        expect_as_many(series);
    }

    bool takes_part(const Setup& setup, std::uint64_t objects) const {
        return setup.finder != Finder::paper_standard_sort || objects == study_.plan.objects.back();
    }

    bool rests(const Point& point, unsigned round) const {
        if (round <= min_rounds) return false;
        double spent = 0;
        for (const Run& run : point.runs) spent += run.seconds;
        return spent > study_.plan.max_seconds;
    }

    void expect_as_many(const Series& series) const {
        const Series& first = study_.series.front();
        const std::uint64_t expected = first.points.back().pairs, pairs = series.points.back().pairs;
        if (pairs == expected) return;
        throw Error(
            ErrorCode::engine_failed,
            fmt::format("{}, {} objects: {} on {} found {} pairs, {} on {} found {}", study_.plan.scene,
                        series.points.back().objects, finder_text(first.setup.finder), processors_text(first.setup),
                        expected, finder_text(series.setup.finder), processors_text(series.setup), pairs));
    }

    void say(const std::string& activity) const {
        if (progress_) progress_(activity, done_ / total_);
    }

    const StudyProgress& progress_;
    std::stop_token stop_;
    Study study_;
    std::vector<std::unique_ptr<Runner>> runners_;  // one for each series
    double done_ = 0, total_ = 0;                   // objects times rounds
};

}  // namespace

std::string processors_text(const Setup& setup) {
    return setup.machines == 1 ? fmt::format("{}", setup.processors())
                               : fmt::format("{} x {}", setup.machines, setup.processors_per_machine);
}

std::string_view finder_text(Finder finder) {
    switch (finder) {
        case Finder::paper:
            return "paper";
        case Finder::paper_standard_sort:
            return "paper, std::sort";
        case Finder::octopair:
            break;
    }
    return "octopair";
}

std::vector<double> Point::seconds() const {
    std::vector<double> seconds;
    seconds.reserve(runs.size());
    for (const Run& run : runs) seconds.push_back(run.seconds);
    return seconds;
}

Steps Point::median_steps() const {
    Steps medians;
    for (double Steps::*const step :
         {&Steps::encode, &Steps::sort, &Steps::merge, &Steps::merge_master, &Steps::scan}) {
        std::vector<double> seconds;
        seconds.reserve(runs.size());
        for (const Run& run : runs) seconds.push_back(run.steps.*step);
        medians.*step = bench::median(std::move(seconds));
    }
    return medians;
}

const Point* Series::point(std::uint64_t objects) const {
    const auto found = std::find_if(points.begin(), points.end(), [&](const Point& p) { return p.objects == objects; });
    return found == points.end() ? nullptr : &*found;
}

Fits Series::fits() const {
    std::vector<Sample> samples;
    samples.reserve(points.size());
    for (const Point& point : points) {
        samples.push_back({double(point.objects), point.median_seconds(), relative_spread(point.seconds())});
    }
    return fit(samples);
}

std::vector<Setup> setups(unsigned threads) {
    std::vector<unsigned> counts;
    for (unsigned count = 1; count < threads; count += count < 4 ? 1 : count) counts.push_back(count);
    counts.push_back(threads);
    std::vector<Setup> all;
    all.reserve(3 * counts.size() + 1);
    for (const unsigned count : counts) {
        all.push_back({Finder::paper, 1, count});
        if (count >= 4 && count % 2 == 0) all.push_back({Finder::paper, count / 2, 2});
    }
    all.push_back({Finder::paper_standard_sort, 1, threads});
    for (const unsigned count : counts) all.push_back({Finder::octopair, 1, count});
    return all;
}

Study measure(const StudyPlan& plan, const StudyProgress& progress, const std::stop_token& stop) {
    return Measurement(plan, progress, stop).run();
}

}  // namespace octopair::paper
