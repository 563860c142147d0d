#include "program/paper_on_machines.hpp"

#include <algorithm>

#include "cli/command/interrupt.hpp"
#include "cli/command/option_values.hpp"
#include "cluster/machines.hpp"
#include "cluster/study.hpp"
#include "octopair/error.hpp"
#include "program/options.hpp"

namespace octopair::bench {

namespace {

constexpr unsigned max_machines = 10'000;
constexpr unsigned ranks_per_machine = 2;  // like in the paper

std::vector<unsigned> parse_machines(const std::vector<std::string>& texts) {
    std::vector<unsigned> machines;
    for (const std::string& text : texts) {
        machines.push_back(unsigned(parse_between("--machines", text, {1, max_machines})));
    }
    std::ranges::sort(machines);
    const auto same = std::ranges::unique(machines);
    machines.erase(same.begin(), same.end());
    return machines;
}

}  // namespace

void add_machines_options(cli::Command& command, MachinesRequest& request) {
    const cli::Option machines =
        command
            .add_option(
                "--machines",
                [&request](const std::vector<std::string>& texts) { request.machines = parse_machines(texts); },
                "measure only tables 1 and 2, on MPI ranks: numbers of machines with 2 processors")
            .type_name("N");
    command
        .add_option(
            "--latency",
            [&request](const std::string& text) {
                request.latency_seconds = cli::parse_length("--latency", text) / 1e6;
            },
            "network model of --machines: latency per message in microseconds (default 10)")
        .needs(machines)
        .type_name("US");
    command
        .add_option(
            "--bandwidth",
            [&request](const std::string& text) {
                request.bytes_per_second = cli::parse_length("--bandwidth", text) * 1e6 / 8;
                if (request.bytes_per_second == 0) throw Error(ErrorCode::usage, "--bandwidth: must be greater than 0");
            },
            "network model of --machines: bandwidth per machine in Mbit/s (default 800)")
        .needs(machines)
        .type_name("MBIT");
    add_mpirun(command, request.mpirun).needs(machines);
}

int run_machines(const MachinesRequest& request, const MachinesScene& scene) {
    const cli::Interrupt interrupt;
    StudyOutput output(scene.output);
    cluster::StudyPlan plan;
    plan.scenes = {scene.scene};
    plan.objects = scene.objects;
    plan.arrangements = {cluster::Arrangement::shared, cluster::Arrangement::paper};
    plan.ranks_per_machine = ranks_per_machine;
    plan.ranks = {1};
    for (const unsigned machines : request.machines) plan.ranks.push_back(machines * ranks_per_machine);
    plan.rounds = scene.rounds;
    plan.mpirun = request.mpirun;
    const auto show = [&](std::string_view activity, double done) { output.show(activity, done); };
    const auto all = cluster::measure(plan, show, interrupt.token());
    cluster::Network network;
    network.latency_seconds = request.latency_seconds.value_or(network.latency_seconds);
    network.bytes_per_second = request.bytes_per_second.value_or(network.bytes_per_second);
    output.write(cluster::machines_text(all, network), cluster::machines_json(all, network), interrupt.token());
    return 0;
}

}  // namespace octopair::bench
