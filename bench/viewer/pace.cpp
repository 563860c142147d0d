// Pace of a scene that a View shows: times of steps without a View, without a page, and with pages that read or not.
//
//     pace [OBJECTS [ROUNDS [STEPS]]]      default: 100,000 objects, 5 rounds, 240 steps at 60 Hz, and 1,000 without pause
//
// In each step, 1 % of the objects move, others in each step. Cases alternate within a round. The pages are in a process of the
// lowest priority. `step` is the median of Scene::step(), `show` that of View::show(); ratios compare with the scene without a View.
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <random>
#include <thread>
#include <vector>

#include "machine/median.hpp"
#include "octopair/scene.hpp"
#include "octopair/view.hpp"
#include "viewer/pages.hpp"

namespace {

using namespace octopair;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

/// A scene with about half a pair per object, of which 1 % moves in each step.
class World {
public:
    explicit World(std::size_t objects) : boxes_(objects), ids_(objects) {
        const float extent = float(std::cbrt(double(objects) * 8));
        std::uniform_real_distribution<float> place(0, extent);
        for (Box3f& box : boxes_) {
            for (int i = 0; i < 3; ++i) {
                box.min[i] = place(random_);
                box.max[i] = box.min[i] + 1;
            }
        }
        scene_.add({std::span<const Box3f>(boxes_)}, ids_);
        scene_.step();
    }

    Scene& scene() { return scene_; }

    const StepResult& step() {
        std::uniform_real_distribution<float> way(-0.2F, 0.2F);
        moved_.clear();
        places_.clear();
        for (std::size_t i = 0; i < ids_.size() / 100; ++i) {
            const std::size_t object = random_() % ids_.size();
            Box3f& box = boxes_[object];
            for (int axis = 0; axis < 3; ++axis) {
                const float by = way(random_);
                box.min[axis] += by;
                box.max[axis] = box.min[axis] + 1;
            }
            moved_.push_back(ids_[object]);
            places_.push_back(box);
        }
        scene_.move(moved_, std::span<const Box3f>(places_));
        return scene_.step();
    }

private:
    std::mt19937 random_{1};
    Scene scene_;
    std::vector<Box3f> boxes_, places_;
    std::vector<ObjectId> ids_, moved_;
};

struct Case {
    const char* name;
    bool view;
    unsigned pages = 0;
    bench::Reading reading = bench::Reading::all;
    bool killed = false;

    std::vector<double> steps = {}, shows = {};
    double longest_show = 0;
    bench::PageBytes bytes = {};
};

/// Runs steps, and adds their times to the case.
void run(World& world, Case& one, int steps, std::chrono::microseconds period) {
    std::optional<View> view;
    std::optional<bench::PageProcess> pages;
    if (one.view) view.emplace(world.scene(), ViewOptions{});
    if (one.pages > 0) {
        pages.emplace(view->address(), one.pages, one.reading);
        for (const auto end = Clock::now() + 10s; view->pages() < one.pages && Clock::now() < end;) {
            view->show(world.step());
            std::this_thread::sleep_for(5ms);
        }
    }
    auto next = Clock::now();
    for (int i = 0; i < steps; ++i) {
        if (one.killed && i == steps / 2) pages->kill();
        const StepResult& result = world.step();
        one.steps.push_back(result.seconds);
        const auto begin = Clock::now();
        if (view) view->show(result);
        const double show = seconds_since(begin);
        one.shows.push_back(show);
        one.longest_show = std::max(one.longest_show, show);
        if (period > 0us) std::this_thread::sleep_until(next += period);
    }
    view.reset();
    if (!pages) return;
    if (one.reading == bench::Reading::first) pages->kill();
    const bench::PageBytes bytes = pages->wait();
    if (bytes.frames > 0) one.bytes = bytes;
}

void measure(World& world, const char* pace, int rounds, int steps, std::chrono::microseconds period) {
    using bench::Reading;
    std::vector<Case> cases = {{"no view", false},
                               {"no page", true},
                               {"1 page reads", true, 1},
                               {"1 page stops reading", true, 1, Reading::first},
                               {"50 pages stop reading", true, 50, Reading::first},
                               {"50 pages read", true, 50},
                               {"1 page is killed", true, 1, Reading::all, true}};
    for (int round = 0; round < rounds; ++round) {
        for (Case& one : cases) run(world, one, steps, period);
    }
    const double alone = octopair::bench::median(cases.front().steps);
    std::printf("\n%s: %d rounds of %d steps\n%-24s %9s %7s %11s %13s %8s %12s %12s\n", pace, rounds, steps, "case",
                "step/us", "ratio", "show/us", "longest/us", "frames", "difference/B", "whole/B");
    for (const Case& one : cases) {
        const double step = octopair::bench::median(one.steps);
        std::printf("%-24s %9.1f %7.3f %11.3f %13.1f %8llu %12.0f %12.0f\n", one.name, step * 1e6, step / alone,
                    octopair::bench::median(one.shows) * 1e6, one.longest_show * 1e6,
                    static_cast<unsigned long long>(one.bytes.frames), one.bytes.median_difference, one.bytes.whole);
    }
}

/// Prints the bytes of a difference frame after one step.
void print_difference(World& world) {
    std::optional<View> view(std::in_place, world.scene(), ViewOptions{.frames_per_second = 1000});
    bench::PageProcess page(view->address(), 1, bench::Reading::all);
    for (int i = 0; i < 20; ++i) {
        view->show(world.step());
        std::this_thread::sleep_for(200ms);
    }
    view.reset();
    const bench::PageBytes bytes = page.wait();
    std::printf("\ndifference after one step: median %.0f bytes, largest %.0f, of %llu frames\n",
                bytes.median_difference, bytes.largest_difference, static_cast<unsigned long long>(bytes.frames));
}

}  // namespace

int main(int count, char** words) {
    if (count == 5 && std::strcmp(words[1], "--pages") == 0) {
        const bool all = std::strcmp(words[4], "all") == 0;
        return bench::run_pages(words[2], unsigned(std::atoi(words[3])),
                                all ? bench::Reading::all : bench::Reading::first);
    }
    const std::size_t objects = count > 1 ? std::size_t(std::atoll(words[1])) : 100'000;
    const int rounds = count > 2 ? std::atoi(words[2]) : 5;
    const int steps = count > 3 ? std::atoi(words[3]) : 240;
    World world(objects);
    measure(world, "60 Hz", rounds, steps, 16'667us);
    measure(world, "without pause", rounds, count > 3 ? steps : 1000, 0us);
    print_difference(world);
    return 0;
}
