// octopair-bench paper: measures figure 5 and tables 1 and 2 of the paper (Lucchesi, Egbert, Harris 2014), by bench/paper.
// With --machines the measurement runs on MPI ranks (paper_on_machines.cpp).
#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "cli/command/interrupt.hpp"
#include "cli/command/option_values.hpp"
#include "octopair/error.hpp"
#include "paper/study.hpp"
#include "paper/tables.hpp"
#include "program/options.hpp"
#include "program/study_output.hpp"
#include "program/subcommands.hpp"
#include "samples/scenes.hpp"

#ifdef OCTOPAIR_WITH_MPI
#include "program/paper_on_machines.hpp"
#endif

namespace octopair::bench {

namespace {

struct PaperRequest {
    paper::StudyPlan plan = {"uniform", {}, 0, 7, 20};  // no objects: default numbers; 0 threads: all cores
    OutputRequest output;
#ifdef OCTOPAIR_WITH_MPI
    MachinesRequest machines;
#endif
};

std::vector<std::uint64_t> objects_or(const std::vector<std::uint64_t>& asked,
                                      const std::vector<std::uint64_t>& usual) {
    return asked.empty() ? usual : asked;
}

std::vector<std::uint64_t> parse_objects(const std::vector<std::string>& texts) {
    std::vector<std::uint64_t> objects;
    objects.reserve(texts.size());
    for (const std::string& text : texts) {
        objects.push_back(parse_between("--objects", text, {.least = 2}));
    }
    std::sort(objects.begin(), objects.end());
    objects.erase(std::unique(objects.begin(), objects.end()), objects.end());
    return objects;
}

int run_paper(PaperRequest request) {
#ifdef OCTOPAIR_WITH_MPI
    if (!request.machines.machines.empty()) {
        if (request.plan.threads != 0) {
            throw Error(ErrorCode::usage, "--threads: with --machines each processor is a rank of one thread");
        }
        return run_machines(request.machines,
                            {request.plan.scene, objects_or(request.plan.objects, {1'000'000, 2'000'000}),
                             request.plan.rounds, request.output});
    }
#endif
    const cli::Interrupt interrupt;
    StudyOutput output(request.output);
    request.plan.objects =
        objects_or(request.plan.objects, {100'000, 250'000, 500'000, 1'000'000, 1'500'000, 2'000'000});
    if (request.plan.threads == 0) request.plan.threads = std::max(1u, std::thread::hardware_concurrency());
    const auto show = [&](std::string_view activity, double done) { output.show(activity, done); };
    const paper::Study study = paper::measure(request.plan, show, interrupt.token());
    output.write(paper::study_text(study), paper::study_json(study), interrupt.token());
    return 0;
}

void add_plan_options(Command& command, PaperRequest& request) {
    constexpr unsigned max_rounds = 1000;
    command
        .add_option(
            "--objects",
            [&request](const std::vector<std::string>& texts) { request.plan.objects = parse_objects(texts); },
            "numbers of objects (default 100000 250000 500000 1000000 1500000 2000000)")
        .type_name("N");
    command
        .add_option(
            "--threads", [&request](const std::string& text) { request.plan.threads = cli::parse_threads(text); },
            "measure on 1 to K processors (default 0: all cores)")
        .type_name("K");
    command
        .add_option(
            "--rounds",
            [&request](const std::string& text) {
                request.plan.rounds = unsigned(parse_between("--rounds", text, {1, max_rounds}));
            },
            "runs per measurement; the median counts (default 7)")
        .type_name("R");
}

}  // namespace

void add_paper(Command& program, Action& action) {
    Command command = program.add_subcommand("paper", "measure the figure and the tables of the paper's section 5");
    const auto request = std::make_shared<PaperRequest>();
    command
        .add_option(
            "--scene",
            [request](const std::string& kind) {
                cli::check_value("--scene", samples::scene_kinds(), kind);
                request->plan.scene = kind;
            },
            "scene kind of octopair generate (default uniform)")
        .type_name("KIND");
    add_plan_options(command, *request);
#ifdef OCTOPAIR_WITH_MPI
    add_machines_options(command, request->machines);
#endif
    add_output_options(command, request->output, "write every measured time as JSON");
    command.set_examples(
        {"octopair-bench paper --threads 2 --json paper.json", "octopair-bench paper --machines 1 5 10 15 20"});
    command.callback([request, &action] { action = [request] { return run_paper(*request); }; });
}

}  // namespace octopair::bench
