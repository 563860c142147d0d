#include "peers/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <new>
#include <optional>

#include "machine/median.hpp"

namespace octopair::bench {

namespace {

struct Runner {
    Row row;
    std::unique_ptr<Contender> contender;
    double spent = 0;
};

double timed_run(Contender& contender, std::span<const Box3f> boxes) {
    const auto begin = std::chrono::steady_clock::now();
    contender.run(boxes);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

bool named(const ComparisonPlan& plan, const ContenderKind& kind) {
    return std::find(plan.only.begin(), plan.only.end(), kind.name) != plan.only.end();
}

bool asked(const ComparisonPlan& plan, const ContenderKind& kind) {
    if (plan.threads > 1 && !kind.threads) return false;
    return plan.only.empty() || named(plan, kind);
}

std::vector<Runner> make_runners(const Scene& scene, const ComparisonPlan& plan) {
    const std::vector<ContenderKind> kinds = contender_kinds();
    std::vector<Runner> runners;
    runners.reserve(kinds.size());
    for (const ContenderKind& kind : kinds) {
        if (!asked(plan, kind)) continue;
        Runner& runner = runners.emplace_back();
        runner.row.contender = kind.name;
        runner.row.limit = kind.limit;
        runner.row.max_objects = kind.max_objects;
        if (scene.boxes.size() > kind.max_objects && !named(plan, kind)) {
            runner.row.state = RowState::left_out;
        } else {
            runner.contender = kind.make(plan.threads);
        }
    }
    return runners;
}

/// Runs a contender once. Compares its pairs with `expected`, or sets `expected`.
void run_first(Runner& runner, std::span<const Box3f> boxes, std::optional<Found>& expected) {
    try {
        runner.contender->prepare(boxes);
        runner.spent = runner.row.first_seconds = timed_run(*runner.contender, boxes);
    } catch (const std::bad_alloc&) {
        runner.contender.reset();
        runner.row.state = RowState::out_of_memory;
        return;
    }
    const Found found = runner.row.found = runner.contender->found();
    if (runner.row.limit) return;
    if (!expected) expected = found;
    runner.row.agrees = found == *expected || (found.hash == 0 && found.pairs == expected->pairs);
}

/// Runs each contender that has not yet used its time.
void run_round(std::vector<Runner>& runners, std::span<const Box3f> boxes, const ComparisonPlan& plan) {
    for (Runner& runner : runners) {
        const bool rests = runner.row.seconds.size() >= plan.min_rounds && runner.spent > plan.max_seconds;
        if (!runner.contender || rests) continue;
        runner.row.seconds.push_back(timed_run(*runner.contender, boxes));
        runner.spent += runner.row.seconds.back();
    }
}

}  // namespace

double Row::median() const { return seconds.empty() ? first_seconds : bench::median(seconds); }

std::vector<Row> compare(const Scene& scene, const ComparisonPlan& plan, const ComparisonProgress& progress) {
    std::vector<Runner> runners = make_runners(scene, plan);
    std::optional<Found> expected;
    for (Runner& runner : runners) {
        if (!runner.contender) continue;
        run_first(runner, scene.boxes, expected);
        progress(fmt::format("first run of {}: {:.2f} ms", runner.row.contender, runner.row.first_seconds * 1e3));
    }
    for (unsigned round = 0; round < plan.rounds && !plan.first; ++round) {
        run_round(runners, scene.boxes, plan);
        progress(fmt::format("round {} of {}", round + 1, plan.rounds));
    }
    std::vector<Row> rows;
    rows.reserve(runners.size());
    for (Runner& runner : runners) rows.push_back(std::move(runner.row));
    return rows;
}

}  // namespace octopair::bench
