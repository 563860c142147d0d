#include "service/measurements.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <random>
#include <thread>

#include "machine/median.hpp"
#include "octopair/client.hpp"
#include "octopair/error.hpp"
#include "octopair/remote_scene.hpp"
#include "octopair/scene.hpp"
#include "samples/scenes.hpp"

namespace octopair::bench {

namespace {

constexpr unsigned threads = 2;

template <typename Work>
double seconds_of(Work&& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Boxes of a scene, a part of which moves by up to half their size per frame.
class Crawl {
public:
    explicit Crawl(std::uint64_t objects) : boxes_(samples::make_scene("uniform", objects, 1)), ids_(boxes_.size()) {}

    template <typename AnyScene>
    void enter(AnyScene& scene) {
        scene.add(Objects{std::span<const Box3f>(boxes_), {}}, ids_);  // every new scene assigns the same ids
    }

    void go_on(std::uint64_t moved) {
        some_.clear();
        places_.clear();
        for (std::uint64_t k = 0; k < moved; ++k) {
            const std::size_t object = random_() % boxes_.size();
            Box3f& box = boxes_[object];
            for (int axis = 0; axis < 3; ++axis) {
                const float way = (box.max[axis] - box.min[axis]) * (float(random_() % 1000) / 1000 - 0.5f);
                box.min[axis] += way;
                box.max[axis] += way;
            }
            some_.push_back(ids_[object]);
            places_.push_back(box);
        }
    }

    /// Returns the seconds of a frame.
    template <typename AnyScene>
    double frame(AnyScene& scene, const StepResult*& result) const {
        return seconds_of([&] {
            scene.move(some_, places_);
            result = &scene.step();
        });
    }

private:
    std::vector<Box3f> boxes_, places_;
    std::vector<ObjectId> ids_, some_;
    std::mt19937_64 random_{2};
};

}  // namespace

AgainstLocal measure_against_local(const std::string& address, std::uint64_t objects, Order order, unsigned rounds) {
    AgainstLocal result{objects, order, {}, {}, {}, true};
    const std::vector<Box3f> boxes = samples::make_scene("uniform", objects, 1);
    const Objects scene{std::span<const Box3f>(boxes), {}};
    const auto local = make_local_engine(threads), remote = connect(address);
    PairList here, there;
    const Options options{order};
    for (unsigned round = 0; round <= rounds; ++round) {
        const double a = seconds_of([&] { local->find_pairs(scene, here, options); });
        const double b = seconds_of([&] { remote->find_pairs(scene, there, options); });
        Job job;
        const double c = seconds_of([&] { job = remote->submit(borrowed(scene), options); });
        job.wait();
        if (round == 0) continue;  // warm-up: the engines allocate memory
        result.local.push_back(a);
        result.remote.push_back(b);
        result.submit.push_back(c);
    }
    result.same = here.to_vector() == there.to_vector();
    return result;
}

Crowd measure_crowd(const std::string& address, const Crowd& what) {
    Crowd result = what;
    const std::vector<Box3f> boxes = samples::make_scene("uniform", what.objects, 1);
    const Objects scene{std::span<const Box3f>(boxes), {}};
    PairList right;
    make_local_engine(1)->find_pairs(scene, right);
    const std::vector<Pair> expected = right.to_vector();
    std::vector<std::unique_ptr<Engine>> engines;
    for (unsigned i = 0; i < what.clients; ++i) engines.push_back(connect(address));
    const std::uint64_t each = what.jobs / what.clients;
    std::vector<std::vector<double>> latencies(what.clients);
    std::vector<std::uint64_t> wrong(what.clients);
    result.seconds = seconds_of([&] {
        std::vector<std::jthread> clients;
        for (unsigned i = 0; i < what.clients; ++i) {
            clients.emplace_back([&, i] {
                PairList pairs;
                for (std::uint64_t job = 0; job < each; ++job) {
                    try {
                        latencies[i].push_back(seconds_of([&] { engines[i]->find_pairs(scene, pairs); }));
                        if (pairs.to_vector() != expected) ++wrong[i];
                    } catch (const Error&) {
                        ++wrong[i];
                    }
                }
            });
        }
    });
    for (unsigned i = 0; i < what.clients; ++i) {
        result.wrong += wrong[i];
        std::copy(latencies[i].begin(), latencies[i].end(), std::back_inserter(result.latencies));
    }
    result.jobs = each * what.clients;
    std::sort(result.latencies.begin(), result.latencies.end());
    return result;
}

SceneAgainstLocal measure_scene(const std::string& address, std::uint64_t objects, std::uint64_t moved,
                                unsigned frames) {
    SceneAgainstLocal result{objects, moved, 0, 0, {}, {}, {}, true};
    Crawl crawl(objects);
    Scene local({.threads = threads});
    RemoteScene remote = connect_scene(address);
    crawl.enter(local);
    crawl.enter(remote);
    (void)local.step();
    result.opening = seconds_of([&] { (void)remote.step(); });
    for (unsigned i = 0; i < frames; ++i) {
        const StepResult *here = nullptr, *there = nullptr;
        crawl.go_on(moved);
        if (i % 2 == 0) result.local.push_back(crawl.frame(local, here));
        result.remote.push_back(crawl.frame(remote, there));
        if (i % 2 != 0) result.local.push_back(crawl.frame(local, here));
        result.above.push_back(result.remote.back() - result.local.back());
        result.changes += double(here->began.size() + here->ended.size()) / frames;
        result.same = result.same && std::ranges::equal(here->began, there->began) &&
                      std::ranges::equal(here->ended, there->ended);
    }
    return result;
}

double quantile(const std::vector<double>& values, double part) {
    if (values.empty()) return 0;
    return values[std::min(values.size() - 1, std::size_t(part * double(values.size())))];
}

}  // namespace octopair::bench
