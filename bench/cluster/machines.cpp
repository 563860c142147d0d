#include "cluster/machines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "machine/machine.hpp"
#include "paper/published.hpp"
#include "paper/tables.hpp"

namespace octopair::cluster {

namespace {

double slowest_of(const EachRank& ranks, double Costs::*step) {
    double most = 0;
    for (const Costs& costs : ranks) most = std::max(most, costs.*step);
    return most;
}

/// Returns the fraction of the other ranks that are on other machines. The same fraction of messages uses the network.
double leaving(const Setup& setup) {
    if (setup.ranks <= setup.ranks_per_machine) return 0;
    return double(setup.ranks - setup.ranks_per_machine) / double(setup.ranks - 1);
}

/// Returns the bytes through the busiest port. With the paper's algorithm both directions of the master's port add up,
/// because ranks send lists only after they have received their objects.
double port_bytes(const Measured& measured) {
    const EachRank& ranks = measured.together;
    const Setup& setup = measured.setup;
    std::vector<double> of_machines((ranks.size() + setup.ranks_per_machine - 1) / setup.ranks_per_machine, 0);
    double to_master = 0;
    for (std::size_t rank = 0; rank < ranks.size(); ++rank) {
        const double bytes = double(ranks[rank].bytes_sent);
        of_machines[rank / setup.ranks_per_machine] += bytes * leaving(setup);
        if (rank > 0 && rank % setup.ranks_per_machine == 0) to_master += bytes;  // merged list of its machine
    }
    if (setup.arrangement == Arrangement::shared) return *std::ranges::max_element(of_machines);
    return double(ranks[0].bytes_sent) * leaving(setup) + to_master;
}

double max_messages(const EachRank& ranks) {
    std::uint64_t most = 0;
    for (const Costs& costs : ranks) most = std::max(most, costs.messages_sent);
    return double(most);
}

const Measured* find(const std::vector<Measured>& all, const Setup& setup) {
    const auto found = std::ranges::find_if(all, [&](const Measured& measured) {
        return measured.setup.same_call(setup) && measured.setup.ranks == setup.ranks;
    });
    return found == all.end() ? nullptr : &*found;
}

/// Table of one scene and number of objects, by processors.
class MachineTable {
public:
    MachineTable(const std::vector<Measured>& all, const Setup& setup, const Network& network)
        : all_(all), setup_(setup), network_(network) {}

    std::string text() const {
        const std::string times =
            fmt::format("{:>13}{:>8}{:>11}{:>12}{:>8}", "computing", "eff.", "network", "run time", "eff.");
        std::string text = heading() + fmt::format("{:>10}{:>22}{:>52}{:>52}\n", "", "as published",
                                                   "the paper's algorithm here", "octopair");
        text += fmt::format("{:>10}{:>14}{:>8}{}{}", "processors", "run time", "eff.", times, times);
        for (const unsigned ranks : processors()) {
            text += fmt::format("\n{:>10}", ranks) + published_cells(ranks) + cells(Arrangement::paper, ranks) +
                    cells(Arrangement::shared, ranks);
        }
        return text + '\n';
    }

private:
    std::string heading() const {
        const auto number =
            std::ranges::find(paper::published_tables, setup_.objects, &paper::PublishedTable::objects) -
            paper::published_tables.begin();
        const bool published = !paper::published_times(setup_.objects).empty();
        return fmt::format("{}un time in microseconds, {}, {} objects, {} processors on each machine\n\n",
                           published ? fmt::format("Table {}: r", number + 1) : "R", setup_.scene,
                           paper::grouped(setup_.objects), setup_.ranks_per_machine);
    }

    std::set<unsigned> processors() const {
        std::set<unsigned> counts;
        for (const Measured& measured : all_) {
            if (measured.setup.scene == setup_.scene && measured.setup.objects == setup_.objects)
                counts.insert(measured.setup.ranks);
        }
        for (const paper::PublishedTime& time : paper::published_times(setup_.objects)) counts.insert(time.processors);
        return counts;
    }

    std::string published_cells(unsigned processors) const {
        const auto times = paper::published_times(setup_.objects);
        const auto time = std::ranges::find(times, processors, &paper::PublishedTime::processors);
        if (time == times.end()) return fmt::format("{:>14}{:>8}", "-", "-");
        return time_cells({double(time->microseconds) / 1e6, processors}, double(times.front().microseconds) / 1e6, 14);
    }

    std::string cells(Arrangement arrangement, unsigned ranks) const {
        Setup setup = setup_;
        setup.arrangement = arrangement;
        setup.ranks = ranks;
        const Measured* const measured = find(all_, setup);
        if (measured == nullptr) return fmt::format("{:>13}{:>8}{:>11}{:>12}{:>8}", "-", "-", "-", "-", "-");
        setup.ranks = 1;
        const Measured* const one = find(all_, setup);
        const Modelled times = modelled(*measured, network_);
        const Modelled serial = one != nullptr ? modelled(*one, network_) : Modelled{};
        return time_cells({times.computing, ranks}, serial.computing, 13) +
               fmt::format("{:>11}", paper::microseconds(times.network)) +
               time_cells({times.all(), ranks}, serial.all(), 12);
    }

    /// Formats a time, in `width` columns, and its efficiency.
    static std::string time_cells(const paper::TimedRun& run, double serial_seconds, int width) {
        const std::string time = fmt::format("{:>{}}", paper::microseconds(run.seconds), width);
        if (run.processors == 1 || serial_seconds == 0) return time + fmt::format("{:>8}", "-");
        return time + fmt::format("{:>7.1f}%", 100 * paper::speedup_of(run, serial_seconds).efficiency);
    }

    const std::vector<Measured>& all_;
    Setup setup_;
    const Network& network_;
};

/// Formats the components of the paper's algorithm next to the paper's figures. Uses the run with most ranks and,
/// among equals, most objects.
std::string components_text(const std::vector<Measured>& all, const Network& network) {
    const Measured* most = nullptr;
    for (const Measured& measured : all) {
        if (measured.setup.arrangement != Arrangement::paper) continue;
        const auto size = [](const Setup& setup) { return std::pair(setup.ranks, setup.objects); };
        if (most == nullptr || size(measured.setup) >= size(most->setup)) most = &measured;
    }
    if (most == nullptr) return {};
    const paper::PublishedComponents& published = paper::published_components;
    const EachRank& ranks = most->alone;
    struct Component {
        std::string_view name;
        std::optional<std::uint64_t> published;
        double seconds;
    };
    const Component components[] = {
        {"octants (plan)", {}, slowest_of(ranks, &Costs::plan)},
        {"octal codes, sort", published.octal_codes + published.sort, slowest_of(ranks, &Costs::build)},
        {"merge (each machine)", published.merge_machine, merged_on_machines(ranks)},
        {"merge at the master", published.merge_master, merged_at_master(ranks)},
        {"scan", {}, slowest_of(ranks, &Costs::scan)},
        {"network (model)", {}, modelled(*most, network).network}};
    std::string text = fmt::format("Components in microseconds, {} objects on {} processors; as published: on {}\n\n",
                                   paper::grouped(most->setup.objects), most->setup.ranks, published.processors);
    text += fmt::format("{:<22}{:>18}{:>18}", "", "as published", "here");
    for (const Component& component : components) {
        const std::string given = component.published ? paper::grouped(*component.published) : "-";
        text += fmt::format("\n{:<22}{:>18}{:>18}", component.name, given, paper::microseconds(component.seconds));
    }
    return text + '\n';
}

}  // namespace

double merged_at_master(const EachRank& ranks) { return ranks.front().merge; }

double merged_on_machines(const EachRank& ranks) {
    double most = 0;
    for (std::size_t rank = 1; rank < ranks.size(); ++rank) most = std::max(most, ranks[rank].merge);
    return most;
}

double critical_path(const Measured& measured) {
    const EachRank& ranks = measured.alone;
    if (measured.setup.arrangement == Arrangement::shared) return slowest(ranks);
    double seconds = merged_on_machines(ranks) + merged_at_master(ranks);
    for (const Step& step : computing_steps) {
        if (step.seconds != &Costs::merge) seconds += slowest_of(ranks, step.seconds);
    }
    return seconds;
}

Modelled modelled(const Measured& measured, const Network& network) {
    const double messages = max_messages(measured.together) * leaving(measured.setup);
    return {critical_path(measured),
            port_bytes(measured) / network.bytes_per_second + messages * network.latency_seconds};
}

std::string machines_text(const std::vector<Measured>& all, const Network& network) {
    std::string text = fmt::format(
        "Computing is measured here: processor time along the critical path. Network is a model, not measured: {} us a "
        "message, {} Mbit/s\non each machine. Run time is the sum of both. eff. is the efficiency relative to one "
        "processor.\n",
        network.latency_seconds * 1e6, network.bytes_per_second * 8 / 1e6);
    std::map<std::pair<std::string, std::uint64_t>, Setup> scenes;
    for (const Measured& measured : all) {
        scenes.try_emplace({measured.setup.scene, measured.setup.objects}, measured.setup);
    }
    for (const auto& [name, setup] : scenes) text += '\n' + MachineTable(all, setup, network).text();
    return text + '\n' + components_text(all, network);
}

std::string machines_json(const std::vector<Measured>& all, const Network& network) {
    using Json = nlohmann::ordered_json;
    Json json = bench::machine_json();
    json["network_model"] = {{"latency_seconds", network.latency_seconds},
                             {"bytes_per_second", network.bytes_per_second}};
    json["runs"] = Json::array();
    for (const Measured& measured : all) {
        const Modelled times = modelled(measured, network);
        Json slowest;
        for (const Step& step : computing_steps) slowest[step.name] = slowest_of(measured.alone, step.seconds);
        json["runs"].push_back({{"scene", measured.setup.scene},
                                {"objects", measured.setup.objects},
                                {"ranks", measured.setup.ranks},
                                {"arrangement", arrangement_name(measured.setup.arrangement)},
                                {"pairs", measured.pairs},
                                {"computing_seconds", times.computing},
                                {"network_seconds", times.network},
                                {"port_bytes", port_bytes(measured)},
                                {"slowest_seconds", slowest},
                                {"merge_machine", merged_on_machines(measured.alone)}});
    }
    return json.dump(2) + '\n';
}

}  // namespace octopair::cluster
