// octopair bench cluster: what a call costs each of so many ranks (bench/cluster).
//
// The program has itself measured: it runs under mpirun, once for each number of ranks, and reads what the first rank wrote.
#include <memory>

#include "cli/bench_options.hpp"
#include "cli/cluster.hpp"
#include "cli/command/failure.hpp"
#include "cli/command/interrupt.hpp"
#include "cli/command/words.hpp"
#include "cli/study_output.hpp"
#include "cli/subcommands.hpp"
#include "cluster/on_ranks.hpp"
#include "cluster/study.hpp"
#include "io/files/atomic_file.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

namespace {

struct ClusterRequest {
    cluster::StudyPlan plan;
    std::string json;      // a file, or empty
    std::string on_ranks;  // where the first rank writes; empty: to run mpirun
    bool quiet = false;
};

void write_file(const std::string& path, const std::string& text) {
    io::AtomicFile file(path);
    file.write(text);
    file.commit();
}

/// Under mpirun.
int measure_on_ranks(const ClusterRequest& request) {
    const Interrupt interrupt;
    Cluster ranks;
    std::vector<cluster::Measured> all;
    try {
        for (const std::string& scene : request.plan.scenes) {
            for (const std::uint64_t objects : request.plan.objects) {
                for (const Arrangement arrangement : request.plan.arrangements) {
                    const cluster::Setup setup{scene, objects, 1, arrangement, request.plan.ranks_per_machine};
                    ranks.joint([&] {
                        all.push_back(
                            cluster::measure_on_ranks(MPI_COMM_WORLD, setup, request.plan.rounds, interrupt.token()));
                    });
                }
            }
        }
        ranks.together([&] {
            if (ranks.first()) write_file(request.on_ranks, cluster::measured_json(all));
        });
        return 0;
    } catch (const Error& error) {
        if (!ranks.ends_alike()) throw;
        if (ranks.first()) (void)fail(error);
        ranks.together([] {});
        return exit_status(error.code());
    }
}

int run_cluster(const ClusterRequest& request) {
    if (!request.on_ranks.empty()) return measure_on_ranks(request);
    const Interrupt interrupt;
    StudyOutput output(request.json, request.quiet);
    const auto show = [&](std::string_view activity, double done) { output.show(activity, done); };
    const auto all = cluster::measure(request.plan, show, interrupt.token());
    output.write(cluster::study_text(all), cluster::study_json(all), interrupt.token());
    return 0;
}

void add_arrangement(Command& command, const std::shared_ptr<ClusterRequest>& request) {
    command
        .add_option(
            "--arrangement",
            [request](const std::vector<std::string>& names) {
                request->plan.arrangements.clear();
                for (const std::string& name : names) {
                    check_word({"--arrangement", {"shared", "paper"}, {}}, name);
                    request->plan.arrangements.push_back(cluster::arrangement_of(name));
                }
            },
            "shared (default), or paper: a master deals out, merges and scans; or both")
        .type_name("WORD");
    command
        .add_option(
            "--ranks-per-machine",
            [request](const std::string& text) {
                request->plan.ranks_per_machine = unsigned(parse_some("--ranks-per-machine", text));
            },
            "in the paper's arrangement (default 2)")
        .type_name("N");
}

}  // namespace

void add_bench_cluster(Command& bench, Action& action) {
    Command command = bench.add_subcommand("cluster", "what a call costs each of so many ranks, in processor time");
    const auto request = std::make_shared<ClusterRequest>();
    add_scenes(command, request->plan.scenes);
    add_numbers(command, "--objects", request->plan.objects, "how many, several times (default 1000000)");
    add_numbers(command, "--ranks", request->plan.ranks, "on how many, several times (default 1 2 5 10 20 40 64)");
    add_arrangement(command, request);
    add_rounds(command, request->plan.rounds);
    command.add_option("--mpirun", request->plan.mpirun, "the command that starts ranks (default mpirun)")
        .type_name("COMMAND");
    command.add_option("--json", request->json, "write every rank's costs as JSON").type_name("FILE");
    command.add_option("--on-ranks", request->on_ranks).hide();
    command.add_flag("--quiet", request->quiet, "no progress on standard error");
    command.callback([request, &action] { action = [request] { return run_cluster(*request); }; });
}

}  // namespace octopair::cli
