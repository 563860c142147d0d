#include "scaling/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cluster/mpirun.hpp"
#include "cluster/temporary_file.hpp"
#include "machine/machine.hpp"

namespace octopair::scaling {

namespace {

void add(std::vector<std::string>& command, const char* name, const std::vector<unsigned>& numbers) {
    command.emplace_back(name);
    for (const unsigned number : numbers) command.push_back(std::to_string(number));
}

/// One scene with one number of objects.
struct Scene {
    std::string kind;
    std::uint64_t objects;
};

Contest measure(const StudyPlan& plan, const Scene& scene, const std::stop_token& stop) {
    const cluster::TemporaryFile file;
    std::vector<std::string> command = {std::filesystem::read_symlink("/proc/self/exe").string(),
                                        "scaling",
                                        "--on-ranks",
                                        file.path(),
                                        "--rounds",
                                        std::to_string(plan.rounds),
                                        "--scene",
                                        scene.kind,
                                        "--objects",
                                        std::to_string(scene.objects)};
    add(command, "--cores", plan.cores);
    add(command, "--threads-per-rank", plan.threads_per_rank);
    if (plan.weak) command.emplace_back("--weak");
    unsigned ranks = 1;
    for (const Setup& setup : setups(plan.cores, plan.threads_per_rank)) ranks = std::max(ranks, setup.ranks);
    cluster::run_under_mpirun({plan.mpirun, ranks, command}, stop);
    return contest_of(file.content());
}

}  // namespace

std::vector<unsigned> doubled(unsigned most) {
    std::vector<unsigned> numbers;
    for (unsigned number = 1; number < most; number *= 2) numbers.push_back(number);
    numbers.push_back(most);
    return numbers;
}

std::vector<Contest> measure(const StudyPlan& plan, const Show& show, const std::stop_token& stop) {
    std::vector<Contest> all;
    const double scenes = double(plan.scenes.size() * plan.objects.size());
    for (const std::string& kind : plan.scenes) {
        for (const std::uint64_t objects : plan.objects) {
            show(fmt::format("{}, {} objects", kind, objects), double(all.size()) / scenes);
            all.push_back(measure(plan, {kind, objects}, stop));
        }
    }
    return all;
}

std::string study_text(const std::vector<Contest>& all) {
    std::string text;
    for (const Contest& contest : all) text += (text.empty() ? "" : "\n") + contest_text(contest);
    return text;
}

std::string study_json(const std::vector<Contest>& all) {
    nlohmann::ordered_json json = bench::machine_json();
    json["results"] = nlohmann::ordered_json::array();
    for (const Contest& contest : all) json["results"].push_back(nlohmann::ordered_json::parse(contest_json(contest)));
    return json.dump(2) + '\n';
}

}  // namespace octopair::scaling
