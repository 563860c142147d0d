#include "cluster/measured.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <numeric>

#include "octopair/error.hpp"

namespace octopair::cluster {

namespace {

using Json = nlohmann::ordered_json;

double sum_of(const EachRank& ranks, std::uint64_t Costs::*count) {
    return std::accumulate(ranks.begin(), ranks.end(), 0.0,
                           [&](double sum, const Costs& costs) { return sum + double(costs.*count); });
}

struct Count {
    const char* name;
    std::uint64_t Costs::*count;
};
constexpr Count counts[] = {
    {"bytes_sent", &Costs::bytes_sent},
    {"messages_sent", &Costs::messages_sent},
    {"objects", &Costs::objects},
    {"shared_objects", &Costs::shared_objects},
    {"objects_received", &Costs::objects_received},
    {"octants", &Costs::octants},
};

Json rank_json(const Costs& costs) {
    Json seconds;
    for (const Step& step : computing_steps) seconds[step.name] = costs.*step.seconds;
    seconds["mpi"] = costs.mpi;
    Json json = {{"cpu_seconds", seconds}};
    for (const Count& count : counts) json[count.name] = costs.*count.count;
    return json;
}

Json ranks_json(const EachRank& ranks) {
    Json json = Json::array();
    for (const Costs& costs : ranks) json.push_back(rank_json(costs));
    return json;
}

Costs rank_of(const Json& json) {
    Costs costs;
    for (const Step& step : computing_steps) json.at("cpu_seconds").at(step.name).get_to(costs.*step.seconds);
    json.at("cpu_seconds").at("mpi").get_to(costs.mpi);
    for (const Count& count : counts) json.at(count.name).get_to(costs.*count.count);
    return costs;
}

EachRank ranks_of(const Json& json) {
    EachRank ranks;
    for (const Json& costs : json) ranks.push_back(rank_of(costs));
    return ranks;
}

}  // namespace

std::string_view arrangement_name(Arrangement arrangement) {
    constexpr std::array<std::string_view, 4> names = {"shared", "space", "blocks", "paper"};
    return names[std::size_t(arrangement)];
}

Arrangement arrangement_of(std::string_view name) {
    using enum Arrangement;
    for (const Arrangement arrangement : {shared, space, blocks, paper}) {
        if (name == arrangement_name(arrangement)) return arrangement;
    }
    throw Error(ErrorCode::usage,
                "'" + std::string(name) + "' is not an arrangement of ranks; there are: shared, space, blocks, paper");
}

double computing(const Costs& costs) {
    double seconds = 0;
    for (const Step& step : computing_steps) seconds += costs.*step.seconds;
    return seconds;
}

double slowest(const EachRank& ranks) {
    double most = 0;
    for (const Costs& costs : ranks) most = std::max(most, computing(costs));
    return most;
}

double mean(const EachRank& ranks) {
    double all = 0;
    for (const Costs& costs : ranks) all += computing(costs);
    return all / double(ranks.size());
}

double Measured::bytes_per_object() const { return sum_of(together, &Costs::bytes_sent) / double(setup.objects); }
double Measured::messages_per_rank() const { return sum_of(together, &Costs::messages_sent) / double(setup.ranks); }
double Measured::shared() const { return sum_of(together, &Costs::shared_objects) / double(setup.objects); }

std::string measured_json(const std::vector<Measured>& all) {
    Json runs = Json::array();
    for (const Measured& measured : all) {
        runs.push_back({{"scene", measured.setup.scene},
                        {"objects", measured.setup.objects},
                        {"ranks", measured.setup.ranks},
                        {"arrangement", arrangement_name(measured.setup.arrangement)},
                        {"ranks_per_machine", measured.setup.ranks_per_machine},
                        {"pairs", measured.pairs},
                        {"entries", measured.entries},
                        {"wall_seconds", measured.wall_seconds},
                        {"together", ranks_json(measured.together)},
                        {"alone", ranks_json(measured.alone)}});
    }
    return runs.dump(2) + '\n';
}

std::vector<Measured> measured_of(const std::string& json) {
    try {
        std::vector<Measured> all;
        for (const Json& run : Json::parse(json)) {
            Measured& measured = all.emplace_back();
            run.at("scene").get_to(measured.setup.scene);
            run.at("objects").get_to(measured.setup.objects);
            run.at("ranks").get_to(measured.setup.ranks);
            measured.setup.arrangement = arrangement_of(run.at("arrangement").get<std::string>());
            run.at("ranks_per_machine").get_to(measured.setup.ranks_per_machine);
            run.at("pairs").get_to(measured.pairs);
            run.at("entries").get_to(measured.entries);
            run.at("wall_seconds").get_to(measured.wall_seconds);
            measured.together = ranks_of(run.at("together"));
            measured.alone = ranks_of(run.at("alone"));
        }
        return all;
    } catch (const Json::exception& error) {
        throw Error(ErrorCode::engine_failed,
                    std::string("cannot read the measurements of the ranks: ") + error.what());
    }
}

}  // namespace octopair::cluster
