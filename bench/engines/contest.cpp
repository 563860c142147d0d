#include "engines/contest.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <stdexcept>

#include "engines/contenders.hpp"
#include "samples/scenes.hpp"

namespace octopair::bench {

namespace {

template <typename Body>
double timed(const Body& body) {
    const auto begin = std::chrono::steady_clock::now();
    body();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// An engine with its boxes and its pair list.
class Runner {
public:
    Runner(const Contender& contender, std::span<const Box3f> boxes, unsigned width) {
        entrant.engine = contender.name;
        entrant.start_seconds = timed([&] { engine_ = contender.make(width); });
        placed_ = contender.place(*engine_, boxes);
    }

    double call(Order order) {
        return timed([&] { engine_->find_pairs({placed_.boxes}, list_, {.order = order}); });
    }

    const PairList& list() const { return list_; }

    Entrant entrant;

private:
    std::unique_ptr<Engine> engine_;
    PlacedBoxes placed_;
    PairList list_;
};

bool equal(const PairList& list, std::span<const Pair> expected) {
    if (list.size() != expected.size()) return false;
    for (const std::span<const Pair> chunk : list.chunks()) {
        if (!std::equal(chunk.begin(), chunk.end(), expected.begin())) return false;
        expected = expected.subspan(chunk.size());
    }
    return true;
}

void judge(std::vector<std::unique_ptr<Runner>>& runners) {
    const std::vector<Pair> expected = runners.front()->list().to_vector();
    for (const auto& runner : runners) {
        Entrant& entrant = runner->entrant;
        entrant.pairs = runner->list().size();
        entrant.agrees = entrant.agrees && equal(runner->list(), expected);
    }
}

}  // namespace

double Entrant::median() const {
    std::vector<double> sorted = seconds;
    std::sort(sorted.begin(), sorted.end());
    const std::size_t half = sorted.size() / 2;
    if (sorted.empty()) return first_seconds;
    return sorted.size() % 2 != 0 ? sorted[half] : (sorted[half - 1] + sorted[half]) / 2;
}

std::vector<Contest> contests(unsigned rounds) {
    std::vector<Contest> all;
    for (const Order order : {Order::octal, Order::ascending}) {
        all.push_back({"uniform", 1'000'000, order, rounds});
        all.push_back({"dense", 1'000'000, order, rounds});
        all.push_back({"uniform", 10'000, order, rounds * 10});
        all.push_back({"uniform", 1'000, order, rounds * 10});
    }
    return all;
}

std::vector<Entrant> hold(const Contest& contest, unsigned width) {
    const std::vector<Box3f> boxes = samples::make_scene(contest.kind, contest.objects, 1);
    std::vector<std::unique_ptr<Runner>> runners;
    for (const Contender& contender : contenders())
        runners.push_back(std::make_unique<Runner>(contender, boxes, width));
    for (const auto& runner : runners) runner->entrant.first_seconds = runner->call(contest.order);
    judge(runners);
    // Each round begins with the next engine, so that no engine has the first place in every round.
    for (std::size_t round = 0; round < contest.rounds; ++round) {
        for (std::size_t i = 0; i < runners.size(); ++i) {
            Runner& runner = *runners[(round + i) % runners.size()];
            runner.entrant.seconds.push_back(runner.call(contest.order));
        }
    }
    judge(runners);
    std::vector<Entrant> entrants;
    entrants.reserve(runners.size());
    for (const auto& runner : runners) entrants.push_back(runner->entrant);
    return entrants;
}

}  // namespace octopair::bench
