#include "scaling/contest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "machine/median.hpp"
#include "octopair/error.hpp"

namespace octopair::scaling {

namespace {

using Json = nlohmann::ordered_json;

std::string counted(unsigned number, const char* what) {
    return fmt::format("{} {}{}", number, what, number == 1 ? "" : "s");
}

std::string row_text(const Contest& contest, const Entrant& entrant) {
    const std::string text =
        fmt::format("  {:<22}{:>7}{:>13}{:>13}{:>12.3f}{:>10.2f}{:>11.1f}%", setup_text(entrant.setup),
                    entrant.setup.cores(), entrant.objects, entrant.pairs, entrant.median() * 1e3,
                    contest.speedup(entrant), 100 * contest.efficiency(entrant));
    const double ratio = contest.against_threads(entrant);
    return text + (ratio > 0 ? fmt::format("{:>11.3f}\n", ratio) : "\n");
}

}  // namespace

std::string setup_text(const Setup& setup) {
    if (setup.local()) return counted(setup.threads, "thread");
    return counted(setup.ranks, "rank") + (setup.threads > 1 ? " x " + counted(setup.threads, "thread") : "");
}

double Entrant::median() const { return bench::median(seconds); }

const Entrant* Contest::find(const Setup& setup) const {
    const auto found = std::ranges::find(entrants, setup, &Entrant::setup);
    return found == entrants.end() ? nullptr : &*found;
}

double Contest::speedup(const Entrant& entrant) const {
    const Entrant& one = *find({0, 1});
    return one.median() / entrant.median() * double(entrant.objects) / double(one.objects);
}

double Contest::against_threads(const Entrant& entrant) const {
    const Entrant* const threads = find({0, entrant.setup.cores()});
    return entrant.setup.local() || threads == nullptr ? 0 : entrant.median() / threads->median();
}

std::vector<Setup> setups(const std::vector<unsigned>& cores, const std::vector<unsigned>& threads_per_rank) {
    std::vector<Setup> all;
    all.reserve(cores.size() * (1 + threads_per_rank.size()));
    for (const unsigned count : cores) all.push_back({0, count});
    for (const unsigned threads : threads_per_rank) {
        for (const unsigned count : cores) {
            if (count % threads == 0) all.push_back({count / threads, threads});
        }
    }
    return all;
}

std::string contest_text(const Contest& contest) {
    std::string text = fmt::format("{}, {} objects{}, {} rounds\n", contest.scene, contest.objects,
                                   contest.weak ? " a core" : "", contest.entrants.front().seconds.size());
    text += fmt::format("  {:<22}{:>7}{:>13}{:>13}{:>12}{:>10}{:>12}{:>11}\n", "", "cores", "objects", "pairs",
                        "median ms", "speedup", "efficiency", "/ threads");
    for (const Entrant& entrant : contest.entrants) text += row_text(contest, entrant);
    return text;
}

std::string contest_json(const Contest& contest) {
    Json rows = Json::array();
    for (const Entrant& entrant : contest.entrants) {
        rows.push_back({{"engine", entrant.setup.local() ? "local" : "mpi"},
                        {"ranks", entrant.setup.ranks},
                        {"threads", entrant.setup.threads},
                        {"cores", entrant.setup.cores()},
                        {"objects", entrant.objects},
                        {"pairs", entrant.pairs},
                        {"median_seconds", entrant.median()},
                        {"speedup", contest.speedup(entrant)},
                        {"efficiency", contest.efficiency(entrant)},
                        {"seconds", entrant.seconds}});
        if (const double ratio = contest.against_threads(entrant); ratio > 0) rows.back()["against_threads"] = ratio;
    }
    const Json json = {{"scene", contest.scene}, {"objects", contest.objects}, {"weak", contest.weak}, {"rows", rows}};
    return json.dump(2) + '\n';
}

Contest contest_of(const std::string& text) {
    try {
        const Json json = Json::parse(text);
        Contest contest{json.at("scene"), json.at("objects"), json.at("weak"), {}};
        for (const Json& row : json.at("rows")) {
            contest.entrants.push_back({{row.at("ranks"), row.at("threads")},
                                        row.at("objects"),
                                        row.at("pairs"),
                                        row.at("seconds").get<std::vector<double>>()});
        }
        return contest;
    } catch (const Json::exception& error) {
        throw Error(ErrorCode::engine_failed,
                    std::string("cannot read the measurements of the ranks: ") + error.what());
    }
}

}  // namespace octopair::scaling
