// Study as JSON.
#include "paper/study.hpp"

#include <nlohmann/json.hpp>

#include "machine/machine.hpp"
#include "paper/published.hpp"

namespace octopair::paper {

namespace {

using Json = nlohmann::ordered_json;

Json steps_json(const Setup& setup, const Steps& steps) {
    if (setup.finder == Finder::octopair) {
        return {{"encode", steps.encode}, {"count", steps.merge}, {"scatter", steps.sort}, {"scan", steps.scan}};
    }
    return {{"octal_codes", steps.encode},
            {"sort", steps.sort},
            {"merge_machine", steps.merge},
            {"merge_master", steps.merge_master},
            {"scan", steps.scan}};
}

Json point_json(const Setup& setup, const Point& point) {
    Json json = {{"objects", point.objects}, {"pairs", point.pairs}};
    if (point.level > 0) json["level"] = point.level;
    json["median_seconds"] = point.median_seconds();
    json["seconds"] = point.seconds();
    json["median_steps"] = steps_json(setup, point.median_steps());
    return json;
}

Json fit_json(const Fit& fit) { return {{"a", fit.a}, {"residual", fit.residual}}; }

Json series_json(const Series& series) {
    const Fits fits = series.fits();
    Json points = Json::array();
    for (const Point& point : series.points) points.push_back(point_json(series.setup, point));
    return {{"finder", finder_text(series.setup.finder)},
            {"processors", series.setup.processors()},
            {"machines", series.setup.machines},
            {"points", points},
            {"fits",
             {{"n", fit_json(fits.linear)},
              {"n_log2_n", fit_json(fits.n_log_n)},
              {"spread", fits.spread},
              {"holds_better", growth_text(fits.growth)}}}};
}

Json published_json() {
    Json tables = Json::array();
    for (const PublishedTable& table : published_tables) {
        Json times = Json::array();
        for (const PublishedTime& time : table.times) {
            times.push_back({{"processors", time.processors}, {"microseconds", time.microseconds}});
        }
        tables.push_back({{"objects", table.objects}, {"times", times}});
    }
    const PublishedComponents& components = published_components;
    return {{"tables", tables},
            {"components",
             {{"processors", components.processors},
              {"octal_codes", components.octal_codes},
              {"sort", components.sort},
              {"merge_machine", components.merge_machine},
              {"merge_master", components.merge_master}}}};
}

}  // namespace

std::string study_json(const Study& study) {
    Json json = bench::machine_json();
    json["scene"] = study.plan.scene;
    json["rounds"] = study.plan.rounds;
    json["series"] = Json::array();
    for (const Series& series : study.series) json["series"].push_back(series_json(series));
    json["published"] = published_json();
    return json.dump(1) + '\n';
}

}  // namespace octopair::paper
