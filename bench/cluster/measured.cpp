#include "cluster/measured.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "octopair/error.hpp"

namespace octopair::cluster {

namespace {

using Json = nlohmann::ordered_json;

double sum_of(const std::vector<RankCosts>& ranks, std::uint64_t RankCosts::*count) {
    return std::accumulate(ranks.begin(), ranks.end(), 0.0,
                           [&](double sum, const RankCosts& costs) { return sum + double(costs.*count); });
}

struct Count {
    const char* name;
    std::uint64_t RankCosts::*count;
};
constexpr Count counts[] = {
    {"bytes_sent", &RankCosts::bytes_sent},
    {"messages_sent", &RankCosts::messages_sent},
    {"objects", &RankCosts::objects},
    {"shared_objects", &RankCosts::shared_objects},
    {"objects_received", &RankCosts::objects_received},
};

Json rank_json(const RankCosts& costs) {
    Json seconds;
    for (const Step& step : computing_steps) seconds[step.name] = costs.*step.seconds;
    seconds["mpi"] = costs.mpi;
    Json json = {{"cpu_seconds", seconds}};
    for (const Count& count : counts) json[count.name] = costs.*count.count;
    return json;
}

RankCosts rank_of(const Json& json) {
    RankCosts costs;
    for (const Step& step : computing_steps) json.at("cpu_seconds").at(step.name).get_to(costs.*step.seconds);
    json.at("cpu_seconds").at("mpi").get_to(costs.mpi);
    for (const Count& count : counts) json.at(count.name).get_to(costs.*count.count);
    return costs;
}

}  // namespace

double Measured::computing(const RankCosts& costs) {
    double seconds = 0;
    for (const Step& step : computing_steps) seconds += costs.*step.seconds;
    return seconds;
}

double Measured::slowest() const {
    double most = 0;
    for (const RankCosts& costs : ranks) most = std::max(most, computing(costs));
    return most;
}

double Measured::mean() const {
    double all = 0;
    for (const RankCosts& costs : ranks) all += computing(costs);
    return all / double(ranks.size());
}

double Measured::bytes_per_object() const { return sum_of(ranks, &RankCosts::bytes_sent) / double(setup.objects); }
double Measured::messages_per_rank() const { return sum_of(ranks, &RankCosts::messages_sent) / double(setup.ranks); }
double Measured::shared() const { return sum_of(ranks, &RankCosts::shared_objects) / double(setup.objects); }

std::string measured_json(const std::vector<Measured>& all) {
    Json runs = Json::array();
    for (const Measured& measured : all) {
        Json ranks = Json::array();
        for (const RankCosts& costs : measured.ranks) ranks.push_back(rank_json(costs));
        runs.push_back({{"scene", measured.setup.scene},
                        {"objects", measured.setup.objects},
                        {"ranks", measured.setup.ranks},
                        {"pairs", measured.pairs},
                        {"entries", measured.entries},
                        {"wall_seconds", measured.wall_seconds},
                        {"costs", ranks}});
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
            run.at("pairs").get_to(measured.pairs);
            run.at("entries").get_to(measured.entries);
            run.at("wall_seconds").get_to(measured.wall_seconds);
            for (const Json& costs : run.at("costs")) measured.ranks.push_back(rank_of(costs));
        }
        return all;
    } catch (const Json::exception& error) {
        throw Error(ErrorCode::engine_failed, std::string("what the ranks measured cannot be read: ") + error.what());
    }
}

}  // namespace octopair::cluster
