// octopair bench scaling: how long a call takes on so many threads, and on so many ranks (bench/scaling).
//
// The program has itself measured: it runs under mpirun, once for each scene, and reads what the first rank wrote.
#include <algorithm>
#include <memory>
#include <thread>

#include "cli/bench_options.hpp"
#include "cli/cluster.hpp"
#include "cli/command/failure.hpp"
#include "cli/command/interrupt.hpp"
#include "cli/study_output.hpp"
#include "cli/subcommands.hpp"
#include "io/files/atomic_file.hpp"
#include "octopair/error.hpp"
#include "scaling/on_ranks.hpp"
#include "scaling/study.hpp"

namespace octopair::cli {

namespace {

struct ScalingRequest {
    scaling::StudyPlan plan;
    std::string json;      // a file, or empty
    std::string on_ranks;  // where the first rank writes; empty: to run mpirun
    bool quiet = false;
};

/// Under mpirun: one scene.
int hold_on_ranks(const ScalingRequest& request) {
    const scaling::StudyPlan& plan = request.plan;
    const Interrupt interrupt;
    Cluster ranks;
    try {
        const scaling::Turns turns{scaling::setups(plan.cores, plan.threads_per_rank), plan.rounds};
        const auto together = [&](const std::function<void()>& part) { ranks.together(part); };
        const scaling::Contest contest =
            scaling::hold_on_ranks(MPI_COMM_WORLD, {plan.scenes.front(), plan.objects.front(), plan.weak, {}}, turns,
                                   together, interrupt.token());
        ranks.together([&] {
            if (!ranks.first()) return;
            io::AtomicFile file(request.on_ranks);
            file.write(scaling::contest_json(contest));
            file.commit();
        });
        return 0;
    } catch (const Error& error) {
        if (!ranks.ends_alike()) throw;
        if (ranks.first()) (void)fail(error);
        ranks.together([] {});
        return exit_status(error.code());
    }
}

/// Each once, and 1 among them.
void complete(std::vector<unsigned>& numbers) {
    numbers.insert(numbers.begin(), 1);
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

int run_scaling(ScalingRequest request) {
    if (request.plan.cores.empty()) {
        request.plan.cores = scaling::doubled(std::clamp(std::thread::hardware_concurrency(), 1u, most_threads));
    }
    if (const unsigned most = request.plan.cores.back(); most > most_threads) {
        throw Error(ErrorCode::usage,
                    "--cores: " + std::to_string(most) + " is more than " + std::to_string(most_threads));
    }
    complete(request.plan.cores);
    complete(request.plan.threads_per_rank);
    if (!request.on_ranks.empty()) return hold_on_ranks(request);
    const Interrupt interrupt;
    StudyOutput output(request.json, request.quiet);
    const auto show = [&](std::string_view activity, double done) { output.show(activity, done); };
    const auto all = scaling::measure(request.plan, show, interrupt.token());
    output.write(scaling::study_text(all), scaling::study_json(all), interrupt.token());
    return 0;
}

}  // namespace

void add_bench_scaling(Command& bench, Action& action) {
    Command command = bench.add_subcommand("scaling", "how long a call takes on so many threads, and on so many ranks");
    const auto request = std::make_shared<ScalingRequest>();
    add_scenes(command, request->plan.scenes);
    add_numbers(command, "--objects", request->plan.objects, "how many, several times (default 1000000)");
    command.add_flag("--weak", request->plan.weak, "so many objects for each core, not in all");
    add_numbers(command, "--cores", request->plan.cores, "on how many, several times (default 1 2 4 ... all)");
    add_numbers(command, "--threads-per-rank", request->plan.threads_per_rank,
                "also ranks of so many threads, several times (default 1)");
    add_rounds(command, request->plan.rounds);
    command.add_option("--mpirun", request->plan.mpirun, "the command that starts ranks (default mpirun)")
        .type_name("COMMAND");
    command.add_option("--json", request->json, "write every time measured as JSON").type_name("FILE");
    command.add_option("--on-ranks", request->on_ranks).hide();
    command.add_flag("--quiet", request->quiet, "no progress on standard error");
    command.callback([request, &action] { action = [request] { return run_scaling(*request); }; });
}

}  // namespace octopair::cli
