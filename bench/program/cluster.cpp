// octopair-bench cluster: costs of a call on each MPI rank, for several numbers of ranks (bench/cluster).
#include <memory>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "cli/command/interrupt.hpp"
#include "cli/command/option_values.hpp"
#include "cluster/measured.hpp"
#include "cluster/study.hpp"
#include "program/on_ranks.hpp"
#include "program/options.hpp"
#include "program/study_output.hpp"
#include "program/subcommands.hpp"

namespace octopair::bench {

namespace {

struct ClusterRequest {
    cluster::StudyPlan plan;
    OutputRequest output;
    std::string on_ranks;  // not empty: this process is a rank; rank 0 writes the results to this file
};

MakeText measure_cluster(const cluster::StudyPlan& plan, cli::Cluster& ranks, const std::stop_token& stop) {
    std::vector<cluster::Measured> all;
    for (const std::string& scene : plan.scenes) {
        for (const std::uint64_t objects : plan.objects) {
            for (const cluster::Arrangement arrangement : plan.arrangements) {
                const cluster::Setup setup{scene, objects, 1, arrangement, plan.ranks_per_machine};
                ranks.joint(
                    [&] { all.push_back(cluster::measure_on_ranks(MPI_COMM_WORLD, setup, plan.rounds, stop)); });
            }
        }
    }
    return [all = std::move(all)] { return cluster::measured_json(all); };
}

int run_cluster(const ClusterRequest& request) {
    const cli::Interrupt interrupt;
    if (!request.on_ranks.empty()) {
        return run_on_ranks(request.on_ranks, [&](cli::Cluster& ranks) {
            return measure_cluster(request.plan, ranks, interrupt.token());
        });
    }
    StudyOutput output(request.output);
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
                    cli::check_value("--arrangement", {"shared", "space", "blocks", "paper"}, name);
                    request->plan.arrangements.push_back(cluster::arrangement_of(name));
                }
            },
            "shared (default), space, blocks (with near objects on each rank), paper (rank 0 distributes); or several")
        .type_name("WORD");
    command
        .add_option(
            "--ranks-per-machine",
            [request](const std::string& text) {
                request->plan.ranks_per_machine = unsigned(parse_between("--ranks-per-machine", text));
            },
            "ranks per machine in the arrangement paper (default 2)")
        .type_name("N");
}

}  // namespace

void add_cluster(Command& program, Action& action) {
    Command command =
        program.add_subcommand("cluster", "measure the costs of a call on each MPI rank, in processor time");
    const auto request = std::make_shared<ClusterRequest>();
    add_scenes(command, request->plan.scenes);
    add_numbers(command, "--objects", request->plan.objects, "numbers of objects (default 1000000)");
    add_numbers(command, "--ranks", request->plan.ranks, "numbers of ranks (default 1 2 5 10 20 40 64)");
    add_arrangement(command, request);
    add_rounds(command, request->plan.rounds);
    add_mpirun(command, request->plan.mpirun);
    add_output_options(command, request->output, "write the costs of every rank as JSON");
    command.add_option("--on-ranks", request->on_ranks).hide();
    command.set_examples({"octopair-bench cluster --ranks 1 2 4 --json cluster.json"});
    command.callback([request, &action] { action = [request] { return run_cluster(*request); }; });
}

}  // namespace octopair::bench
