// octopair bench: measurements. `paper` is the paper's section 5 again (bench/paper; on ranks: bench_machines.cpp);
// bench_cluster.cpp has `cluster`.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <thread>

#include "cli/command/interrupt.hpp"
#include "cli/command/numbers.hpp"
#include "cli/study_output.hpp"
#include "cli/subcommands.hpp"
#include "octopair/error.hpp"
#include "paper/json.hpp"
#include "paper/study.hpp"
#include "paper/tables.hpp"
#include "samples/scenes.hpp"

#ifdef OCTOPAIR_WITH_MPI
#include "cli/bench_machines.hpp"
#endif

namespace octopair::cli {

namespace {

struct BenchRequest {
    paper::StudyPlan plan = {"uniform", {}, 0, 7, 20};  // no objects: the paper's numbers
    std::string json;                                   // a file, or empty
    bool quiet = false;
#ifdef OCTOPAIR_WITH_MPI
    MachinesRequest machines;
#endif
};

std::vector<std::uint64_t> objects_or(const std::vector<std::uint64_t>& asked,
                                      const std::vector<std::uint64_t>& usual) {
    return asked.empty() ? usual : asked;
}

struct Bounds {
    std::uint64_t least, most;
};

/// A whole number within `bounds`. Throws Error{usage} that names `option`.
std::uint64_t parse_between(std::string_view option, const std::string& text, const Bounds& bounds) {
    const std::uint64_t number = parse_count(option, text, bounds.most);
    if (number >= bounds.least) return number;
    throw Error(ErrorCode::usage, fmt::format("{}: {} is less than {}", option, number, bounds.least));
}

std::vector<std::uint64_t> parse_objects(const std::vector<std::string>& texts) {
    std::vector<std::uint64_t> objects;
    objects.reserve(texts.size());
    for (const std::string& text : texts) {
        objects.push_back(parse_between("--objects", text, {2, std::numeric_limits<std::uint32_t>::max()}));
    }
    std::sort(objects.begin(), objects.end());
    objects.erase(std::unique(objects.begin(), objects.end()), objects.end());
    return objects;
}

int run_paper(BenchRequest request) {
#ifdef OCTOPAIR_WITH_MPI
    if (!request.machines.machines.empty()) {
        if (request.plan.threads != 0) {
            throw Error(ErrorCode::usage, "--threads: with --machines each processor is a rank of one thread");
        }
        return run_machines(request.machines,
                            {request.plan.scene, objects_or(request.plan.objects, {1'000'000, 2'000'000}),
                             request.plan.rounds, request.json, request.quiet});
    }
#endif
    const Interrupt interrupt;
    StudyOutput output(request.json, request.quiet);
    request.plan.objects =
        objects_or(request.plan.objects, {100'000, 250'000, 500'000, 1'000'000, 1'500'000, 2'000'000});
    if (request.plan.threads == 0) request.plan.threads = std::max(1u, std::thread::hardware_concurrency());
    const auto show = [&](std::string_view activity, double done) { output.show(activity, done); };
    const paper::Study study = paper::measure(request.plan, show, interrupt.token());
    output.write(paper::study_text(study), paper::study_json(study), interrupt.token());
    return 0;
}

void add_numbers(Command& command, BenchRequest& request) {
    constexpr unsigned most_rounds = 1000;
    command
        .add_option(
            "--objects",
            [&request](const std::vector<std::string>& texts) { request.plan.objects = parse_objects(texts); },
            "how many, several times (default 100000 250000 500000 1000000 1500000 2000000)")
        .type_name("N");
    command
        .add_option(
            "--threads",
            [&request](const std::string& text) {
                request.plan.threads = unsigned(parse_count("--threads", text, most_threads));
            },
            "on 1 to K processors (default 0: all cores)")
        .type_name("K");
    command
        .add_option(
            "--rounds",
            [&request](const std::string& text) {
                request.plan.rounds = unsigned(parse_between("--rounds", text, {1, most_rounds}));
            },
            "runs of each, of which the median counts (default 7)")
        .type_name("R");
}

void add_paper(Command& bench, Action& action) {
    Command command = bench.add_subcommand("paper", "the figure and the tables of the paper's section 5");
    const auto request = std::make_shared<BenchRequest>();
    command
        .add_option(
            "--scene",
            [request](const std::string& kind) {
                (void)samples::scene_description(kind);
                request->plan.scene = kind;
            },
            "a kind of octopair generate (default uniform)")
        .type_name("KIND");
    add_numbers(command, *request);
#ifdef OCTOPAIR_WITH_MPI
    add_machines_options(command, request->machines);
#endif
    command.add_option("--json", request->json, "write every time measured as JSON").type_name("FILE");
    command.add_flag("--quiet", request->quiet, "no progress on standard error");
    command.callback([request, &action] { action = [request] { return run_paper(*request); }; });
}

}  // namespace

void add_bench(Command& program, Action& action) {
    Command command = program.add_subcommand("bench", "measure");
    command.require_subcommand();
    add_paper(command, action);
#ifdef OCTOPAIR_WITH_MPI
    add_bench_cluster(command, action);
    add_bench_scaling(command, action);
#endif
}

}  // namespace octopair::cli
