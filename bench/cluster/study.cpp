#include "cluster/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <tuple>

#include "cluster/mpirun.hpp"
#include "cluster/temporary_file.hpp"
#include "machine/machine.hpp"

namespace octopair::cluster {

namespace {

namespace fs = std::filesystem;

const Measured* on_one_rank(const std::vector<Measured>& all, const Setup& setup) {
    const auto found = std::ranges::find_if(
        all, [&](const Measured& other) { return other.setup.ranks == 1 && other.setup.same_call(setup); });
    return found == all.end() ? nullptr : &*found;
}

std::string costs_text(const EachRank& ranks, const EachRank* one) {
    const std::string text =
        fmt::format("{:>12.3f}{:>11.3f}{:>11.3f}", slowest(ranks) * 1e3, mean(ranks) * 1e3, imbalance(ranks));
    return text +
           (one != nullptr ? fmt::format("{:>11.1f}%", 100 * efficiency(*one, ranks)) : fmt::format("{:>12}", "-"));
}

std::string row_text(const Measured& measured, const Measured* one) {
    return fmt::format("{:>6}", measured.setup.ranks) +
           costs_text(measured.alone, one != nullptr ? &one->alone : nullptr) +
           fmt::format("{:>8.2f}%{:>9.1f}{:>10.0f}", 100 * measured.shared(), measured.bytes_per_object(),
                       measured.messages_per_rank()) +
           costs_text(measured.together, one != nullptr ? &one->together : nullptr) + '\n';
}

std::string heading_text(const Measured& measured) {
    const std::string costs =
        fmt::format("{:>12}{:>11}{:>11}{:>12}", "slowest ms", "mean ms", "imbalance", "efficiency");
    std::string arranged;
    if (measured.setup.arrangement == Arrangement::paper) {
        arranged = fmt::format(", arranged as in the paper, {} to a machine", measured.setup.ranks_per_machine);
    }
    return fmt::format("{} objects, {}: {} pairs{}\n\n{:>6}{}{:>9}{:>9}{:>10}{}\n", measured.setup.objects,
                       measured.setup.scene, measured.pairs, arranged, "ranks", costs, "shared", "bytes/n", "messages",
                       costs);
}

}  // namespace

std::vector<Measured> measure(const StudyPlan& plan, const Show& show, const std::stop_token& stop) {
    const std::string program = fs::read_symlink("/proc/self/exe").string();
    std::vector<Measured> all;
    for (std::size_t i = 0; i < plan.ranks.size(); ++i) {
        const unsigned ranks = plan.ranks[i];
        show(fmt::format("on {} rank{}", ranks, ranks == 1 ? "" : "s"), double(i) / double(plan.ranks.size()));
        const TemporaryFile file;
        std::vector<std::string> command = {
            program, "cluster", "--on-ranks", file.path(), "--rounds", std::to_string(plan.rounds), "--scene"};
        command.insert(command.end(), plan.scenes.begin(), plan.scenes.end());
        command.emplace_back("--objects");
        for (const std::uint64_t objects : plan.objects) command.push_back(std::to_string(objects));
        command.emplace_back("--arrangement");
        for (const Arrangement arrangement : plan.arrangements) command.emplace_back(arrangement_name(arrangement));
        command.insert(command.end(), {"--ranks-per-machine", std::to_string(plan.ranks_per_machine)});
        run_under_mpirun({plan.mpirun, ranks, command}, stop);
        const std::vector<Measured> measured = measured_of(file.content());
        all.insert(all.end(), measured.begin(), measured.end());
    }
    return all;
}

std::string study_text(const std::vector<Measured>& all) {
    std::string text;
    std::vector<const Measured*> rows;
    rows.reserve(all.size());
    for (const Measured& measured : all) rows.push_back(&measured);
    std::ranges::stable_sort(rows, {}, [](const Measured* row) {
        return std::tuple(row->setup.scene, row->setup.objects, row->setup.arrangement);
    });
    const Setup* last = nullptr;
    for (const Measured* row : rows) {
        if (last == nullptr || !last->same_call(row->setup)) {
            text += (last == nullptr ? "" : "\n") + heading_text(*row);
        }
        text += row_text(*row, on_one_rank(all, row->setup));
        last = &row->setup;
    }
    return text;
}

std::string study_json(const std::vector<Measured>& all) {
    nlohmann::ordered_json json = {{"machine", bench::machine_json()}};
    json["runs"] = nlohmann::ordered_json::parse(measured_json(all));
    return json.dump(2) + '\n';
}

}  // namespace octopair::cluster
