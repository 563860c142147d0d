// octopair-bench scaling: time of a call by number of threads and of MPI ranks (bench/scaling).
#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "cli/command/interrupt.hpp"
#include "octopair/error.hpp"
#include "octopair/limits.hpp"
#include "program/on_ranks.hpp"
#include "program/options.hpp"
#include "program/study_output.hpp"
#include "program/subcommands.hpp"
#include "scaling/contest.hpp"
#include "scaling/study.hpp"

namespace octopair::bench {

namespace {

struct ScalingRequest {
    scaling::StudyPlan plan;
    OutputRequest output;
    std::string on_ranks;  // not empty: this process is a rank; rank 0 writes the results to this file
};

/// Measures the first scene of the plan.
MakeText measure_scaling(const scaling::StudyPlan& plan, cli::Cluster& ranks, const std::stop_token& stop) {
    const scaling::Turns turns{scaling::setups(plan.cores, plan.threads_per_rank), plan.rounds};
    const auto together = [&](const std::function<void()>& part) { ranks.together(part); };
    auto contest = scaling::hold_on_ranks(MPI_COMM_WORLD, {plan.scenes.front(), plan.objects.front(), plan.weak, {}},
                                          turns, together, stop);
    return [contest = std::move(contest)] { return scaling::contest_json(contest); };
}

/// Adds 1 to ascending numbers, and removes duplicates.
void complete(std::vector<unsigned>& numbers) {
    numbers.insert(numbers.begin(), 1);
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

int run_scaling(ScalingRequest request) {
    if (request.plan.cores.empty()) {
        request.plan.cores = scaling::doubled(std::clamp(std::thread::hardware_concurrency(), 1u, max_threads));
    }
    if (const unsigned most = request.plan.cores.back(); most > max_threads) {
        throw Error(ErrorCode::usage,
                    "--cores: " + std::to_string(most) + " is not in the range 1 to " + std::to_string(max_threads));
    }
    complete(request.plan.cores);
    complete(request.plan.threads_per_rank);
    const cli::Interrupt interrupt;
    if (!request.on_ranks.empty()) {
        return run_on_ranks(request.on_ranks, [&](cli::Cluster& ranks) {
            return measure_scaling(request.plan, ranks, interrupt.token());
        });
    }
    StudyOutput output(request.output);
    const auto show = [&](std::string_view activity, double done) { output.show(activity, done); };
    const auto all = scaling::measure(request.plan, show, interrupt.token());
    output.write(scaling::study_text(all), scaling::study_json(all), interrupt.token());
    return 0;
}

}  // namespace

void add_scaling(Command& program, Action& action) {
    Command command =
        program.add_subcommand("scaling", "measure the time of a call by number of threads and of MPI ranks");
    const auto request = std::make_shared<ScalingRequest>();
    add_scenes(command, request->plan.scenes);
    add_numbers(command, "--objects", request->plan.objects, "numbers of objects (default 1000000)");
    command.add_flag("--weak", request->plan.weak, "number of objects per core, not in total");
    add_numbers(command, "--cores", request->plan.cores, "numbers of cores (default 1 2 4 ... all)");
    add_numbers(command, "--threads-per-rank", request->plan.threads_per_rank,
                "numbers of threads per rank (default 1)");
    add_rounds(command, request->plan.rounds);
    add_mpirun(command, request->plan.mpirun);
    add_output_options(command, request->output, "write every measured time as JSON");
    command.add_option("--on-ranks", request->on_ranks).hide();
    command.set_examples({"octopair-bench scaling --objects 1000000"});
    command.callback([request, &action] { action = [request] { return run_scaling(*request); }; });
}

}  // namespace octopair::bench
