#include "cli/detect/detect_report.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>

#include "cli/command/option_values.hpp"
#include "io/results/collision_row.hpp"

namespace octopair::cli {

void DetectReport::add_search(const Summary& search) {
    candidates += search.pairs;
    entries += search.entries;
    steps.encode += search.steps.encode;
    steps.count += search.steps.count;
    steps.scatter += search.steps.scatter;
    steps.scan += search.steps.scan;
    add(search.verification);
}

void DetectReport::add(const Verification& verification) {
    verified = verification.done;
    add_not_checked(verification.not_checked);
    seconds.verify += verification.seconds;
}

void DetectReport::add_not_checked(std::string_view what) {
    if (what.empty() || not_checked.find(what) != std::string::npos) return;
    not_checked += (not_checked.empty() ? "" : "; ") + std::string(what);
}

void DetectReport::add(const Summary& summary, double written) {
    add_search(summary);
    pairs += summary.pairs;
    truncated |= summary.truncated;
    seconds.detect += std::max(0.0, summary.seconds - written);
}

void DetectReport::add(const PipelineSummary& summary, double written) {
    add_search(summary.search);
    pairs += summary.collisions;
    truncated |= summary.truncated;
    seconds.detect += summary.search.seconds;
    const double search = summary.search.seconds + summary.search.verification.seconds;
    seconds.filter += std::max(0.0, summary.seconds - search - written);
    for (std::size_t i = 0; i < of_class.size(); ++i) of_class[i] += summary.of_class[i];
    filters.resize(summary.filters.size());
    for (std::size_t i = 0; i < filters.size(); ++i) {
        const FilterCounts& counts = summary.filters[i];
        filters[i].name = counts.name;
        filters[i].in += counts.in;
        filters[i].out += counts.out;
        filters[i].undecided += counts.undecided;
        filters[i].seconds += counts.seconds;
    }
}

namespace {

/// Returns the largest peak memory of one process: this one, the child that read a mesh file, or a worker.
std::uint64_t peak_rss_bytes() {
    std::uint64_t peak = 0;
    for (const auto who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
        rusage usage{};
        ::getrusage(who, &usage);
        peak = std::max(peak, std::uint64_t(usage.ru_maxrss) * 1024);
    }
    return peak;
}

std::string duration(double seconds) {
    return seconds < 0.1 ? fmt::format("{:.2f} ms", seconds * 1e3) : fmt::format("{:.3f} s", seconds);
}

/// Part of a time.
struct TimePart {
    std::string_view name;
    double seconds;
};

/// Prints times that add up. All of them have one unit and the same number of digits, and are rounded down: so the sum of the parts
/// is never more than the total, and `other` is the rest.
class TimeScale {
public:
    explicit TimeScale(double total) : in_seconds_(total >= 10) {}

    std::string text(double seconds) const { return text(ticks(seconds)); }
    /// Returns "TOTAL = NAME TIME + ... + other TIME".
    std::string sum_text(double total, std::span<const TimePart> parts) const {
        std::int64_t sum = 0;
        std::string terms;
        for (const auto& [name, seconds] : parts) {
            sum += ticks(seconds);
            terms += fmt::format("{} {} + ", name, text(seconds));
        }
        const std::int64_t whole = std::max(ticks(total), sum);
        return fmt::format("{} = {}other {}", text(whole), terms, text(whole - sum));
    }

private:
    std::int64_t ticks(double seconds) const { return std::int64_t(seconds * (in_seconds_ ? 1e3 : 1e5)); }
    std::string text(std::int64_t ticks) const {
        return in_seconds_ ? fmt::format("{:.3f} s", double(ticks) / 1e3)
                           : fmt::format("{:.2f} ms", double(ticks) / 1e2);
    }

    bool in_seconds_;
};

std::string speed(double objects_per_second) {
    return objects_per_second < 1e6 ? grouped(std::uint64_t(objects_per_second)) + " objects/s"
                                    : fmt::format("{:.1f} million objects/s", objects_per_second / 1e6);
}

std::string plural(unsigned count, std::string_view what) {
    return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

/// Returns the seconds of all steps. Keys of unknown times are left out.
nlohmann::ordered_json seconds_json(const DetectReport& report) {
    nlohmann::ordered_json seconds = {
        {"total", report.seconds.total}, {"read", report.seconds.read}, {"detect", report.seconds.detect}};
    if (!report.events) {
        seconds["encode"] = report.steps.encode;
        seconds["count"] = report.steps.count;
        seconds["scatter"] = report.steps.scatter;
        seconds["scan"] = report.steps.scan;
        seconds["prepare"] = report.seconds.prepare;
        seconds["filter"] = report.seconds.filter;
    }
    seconds["write"] = report.seconds.write;
    if (report.verified) seconds["verify"] = report.seconds.verify;
    return seconds;
}

nlohmann::ordered_json filters_json(const DetectReport& report) {
    auto filters = nlohmann::ordered_json::array();
    for (const FilterCounts& filter : report.filters) {
        filters.push_back({{"name", filter.name}, {"in", filter.in}, {"out", filter.out}, {"seconds", filter.seconds}});
    }
    return filters;
}

/// Returns the lines with the seconds of each part of the run, and of each step of the search.
std::string time_text(const DetectReport& report) {
    const DetectSeconds& seconds = report.seconds;
    const TimeScale scale(seconds.total);
    std::vector<TimePart> parts = {{"read", seconds.read}};
    if (!report.filters.empty()) parts.push_back({"prepare", seconds.prepare});
    parts.push_back({"detect", seconds.detect});
    if (!report.filters.empty()) parts.push_back({"filter", seconds.filter});
    if (report.verified) parts.push_back({"verify", seconds.verify});
    parts.push_back({"write", seconds.write});
    std::string text = fmt::format("time        {}\n", scale.sum_text(seconds.total, parts));
    if (report.events) return text;
    const StepSeconds& steps = report.steps;
    const std::array<TimePart, 4> of_steps = {
        {{"encode", steps.encode}, {"count", steps.count}, {"scatter", steps.scatter}, {"scan", steps.scan}}};
    return text + fmt::format("detect      {}\n", scale.sum_text(seconds.detect, of_steps));
}

/// Returns the line of --verify: what was checked, and what was not.
std::string verified_text(const DetectReport& report) {
    if (!report.verified) return {};
    std::string text = fmt::format("verified    {} {} by a second algorithm", grouped(report.candidates),
                                   report.filters.empty() ? "pairs" : "candidates");
    if (report.collisions_verified) text += fmt::format(", {} collisions by certificates", grouped(report.pairs));
    text += fmt::format(" in {}", TimeScale(report.seconds.total).text(report.seconds.verify));
    if (!report.not_checked.empty()) text += fmt::format(" (not checked: {})", report.not_checked);
    return text + '\n';
}

/// Number of pairs that filters could not decide.
struct UndecidedPairs {
    std::uint64_t open = 0;   ///< one object may be inside the other, an open mesh
    std::uint64_t thick = 0;  ///< penetrating, because the overlap may be thicker than the tolerance
};
UndecidedPairs undecided_pairs(const DetectReport& report) {
    UndecidedPairs pairs;
    for (const FilterCounts& filter : report.filters) {
        (filter.name == "exact feature" ? pairs.thick : pairs.open) += filter.undecided;
    }
    return pairs;
}

std::string pairs_text(std::uint64_t pairs) { return fmt::format("{} pair{}", grouped(pairs), pairs == 1 ? "" : "s"); }

/// Returns where the tolerance comes from, in parentheses; empty for --tolerance.
std::string tolerance_source(const DetectReport& report) {
    if (!report.tolerance_is_default) return {};
    constexpr std::string_view precision = "the precision of float32";
    const double of_chord = 2 * report.chord;
    if (of_chord == 0) return fmt::format(" ({})", precision);
    const bool both = *report.tolerance > of_chord;
    return fmt::format(" (twice the chord error {:.3g}{}{})", report.chord, both ? ", and " : "",
                       both ? precision : "");
}

/// Returns the lines about the exact stages: classes, tolerance, and objects without an inside.
std::string exact_text(const DetectReport& report) {
    std::string text, classes;
    for (std::size_t i = 1; i < report.of_class.size(); ++i) {
        if (report.of_class[i] == 0) continue;
        classes += fmt::format("{}{} {}", classes.empty() ? "" : ", ", grouped(report.of_class[i]),
                               io::word_of(CollisionClass(i)));
    }
    if (!classes.empty()) text += fmt::format("classes     {}\n", classes);
    if (report.tolerance) {
        text += fmt::format("tolerance   {:.3g}{}\n", *report.tolerance, tolerance_source(report));
    }
    const UndecidedPairs undecided = undecided_pairs(report);
    if (undecided.thick > 0) {
        text +=
            fmt::format("undecided   {} penetrating: whether the overlap is thicker than the tolerance is not proven\n",
                        pairs_text(undecided.thick));
    }
    if (report.open_objects == 0) return text;
    if (undecided.open > 0 && report.of_class[std::size_t(CollisionClass::undecided)] == 0) {
        text +=
            fmt::format("undecided   {} left out: an object is in the bounds of one that is not closed (--classes)\n",
                        pairs_text(undecided.open));
    }
    return text + fmt::format("not closed  {} of {} objects have no inside (--weld joins vertices): {}{}\n",
                              grouped(report.open_objects), grouped(report.objects), fmt::join(report.first_open, ", "),
                              report.open_objects > report.first_open.size() ? ", ..." : "");
}

/// Returns the line about the unit, with the inputs that were converted to it.
std::string unit_text(const DetectReport& report) {
    if (report.unit.empty()) return {};
    constexpr std::size_t named = 3;
    std::string converted;
    for (std::size_t i = 0; i < std::min(report.converted.size(), named); ++i) {
        const Part& part = report.converted[i];
        converted += fmt::format("{}{} from {}", i == 0 ? "; converted: " : ", ", part.path, part.converted_from);
    }
    return fmt::format("unit        {}{}{}\n", report.unit, converted, report.converted.size() > named ? ", ..." : "");
}

/// Returns the line about the elements of IFC models: how many were read, and what is left out on purpose.
std::string elements_text(const DetectReport& report) {
    const io::ElementCounts& elements = report.elements;
    if (elements.with_geometry == 0 && elements.left_out.empty()) return {};
    std::string left_out;
    for (const io::TypeCount& type : elements.left_out)
        left_out +=
            fmt::format("{}{} {}", left_out.empty() ? "; left out on purpose: " : ", ", type.type, grouped(type.count));
    return fmt::format("elements    {} of {} with geometry were read{}\n", grouped(elements.read),
                       grouped(elements.with_geometry), left_out);
}

nlohmann::ordered_json elements_json(const io::ElementCounts& elements) {
    nlohmann::ordered_json json = {{"with_geometry", elements.with_geometry}, {"read", elements.read}};
    json["lost"] = nlohmann::ordered_json::array();
    for (const io::LostElements& lost : elements.lost) {
        json["lost"].push_back(
            {{"file", lost.file}, {"type", lost.type}, {"count", lost.count}, {"first", lost.first}});
    }
    json["left_out"] = nlohmann::ordered_json::object();
    for (const io::TypeCount& type : elements.left_out) json["left_out"][type.type] = type.count;
    return json;
}

/// Returns the counts of all classes that collisions have.
nlohmann::ordered_json classes_json(const DetectReport& report) {
    nlohmann::ordered_json classes = nlohmann::ordered_json::object();
    for (std::size_t i = 1; i < report.of_class.size(); ++i) {
        if (report.of_class[i] > 0) classes[std::string(io::word_of(CollisionClass(i)))] = report.of_class[i];
    }
    return classes;
}

/// Returns the number of rows of a status. Resolved: the number of collisions that are not found any more.
std::uint64_t count_of(io::Status status, const io::StatusCounts& counts) {
    return status == io::Status::resolved ? counts.resolved : counts.found[std::size_t(status)];
}

/// Returns the line of the statuses; empty without --statuses.
std::string statuses_text(const DetectReport& report) {
    if (!report.statuses) return {};
    std::string text;
    for (std::size_t i = 0; i < io::status_values; ++i) {
        const io::Status status{std::uint8_t(i)};
        text += fmt::format("{}{} {}", text.empty() ? "statuses    " : ", ",
                            grouped(count_of(status, *report.statuses)), io::word_of(status));
    }
    return text + '\n';
}

nlohmann::ordered_json statuses_json(const io::StatusCounts& counts) {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    for (std::size_t i = 0; i < io::status_values; ++i) {
        const io::Status status{std::uint8_t(i)};
        json[std::string(io::word_of(status))] = count_of(status, counts);
    }
    return json;
}

/// Returns a line per filter: pairs out and in, and the seconds summed over all threads.
std::string filters_text(const DetectReport& report) {
    if (report.filters.empty()) return {};
    std::string text = fmt::format("candidates  {}\n", grouped(report.candidates));
    for (const FilterCounts& filter : report.filters) {
        text += fmt::format("filter      {}: {} of {} in {}\n", filter.name, grouped(filter.out), grouped(filter.in),
                            duration(filter.seconds));
    }
    return text;
}

}  // namespace

std::string summary_text(const DetectReport& report) {
    const DetectSeconds& seconds = report.seconds;
    std::string text = fmt::format("objects     {}", grouped(report.objects));
    if (report.moving) text += fmt::format(" in each of {} frames", grouped(report.frames));
    text += fmt::format("\npairs       {}", grouped(report.pairs));
    if (report.events) {
        text += fmt::format("\nevents      {} began, {} ended", grouped(report.events->began),
                            grouped(report.events->ended));
    }
    text += report.truncated ? " (the limit was reached; more exist)\n" : "\n";
    if (report.changes) {
        text += fmt::format("changes     {} new, {} same, {} gone\n", grouped(report.changes->begun),
                            grouped(report.changes->same), grouped(report.changes->gone));
    }
    text += unit_text(report) + elements_text(report);
    text += statuses_text(report);
    for (const std::string& warning : report.warnings) text += fmt::format("warning     {}\n", warning);
    text += exact_text(report) + filters_text(report) + verified_text(report) + time_text(report);
    const double objects = double(report.objects) * double(report.frames);
    if (seconds.detect > 0) text += fmt::format("throughput  {}", speed(objects / seconds.detect));
    const EngineDescription& engine = report.engine;
    if (!engine.server.empty()) return text + fmt::format(" on server {}\n", engine.server);
    if (engine.ranks > 0) {
        return text +
               fmt::format(" on {} with {} each\n", plural(engine.ranks, "rank"), plural(engine.threads, "thread"));
    }
    return text + " on " + (engine.workers > 0 ? plural(engine.workers, "worker") : plural(engine.threads, "thread")) +
           '\n';
}

std::string stats_json(const DetectReport& report) {
    nlohmann::ordered_json stats = {
        {"objects", report.objects},          {"frames", report.frames},          {"pairs", report.pairs},
        {"truncated", report.truncated},      {"verified", report.verified},      {"engine", report.engine.engine},
        {"threads", report.engine.threads},   {"workers", report.engine.workers}, {"entries", report.entries},
        {"peak_rss_bytes", peak_rss_bytes()}, {"seconds", seconds_json(report)}};
    if (!report.not_checked.empty()) stats["not_checked"] = report.not_checked;
    if (report.engine.ranks > 0) stats["ranks"] = report.engine.ranks;
    if (!report.engine.server.empty()) stats["server"] = report.engine.server;
    if (!report.filters.empty()) stats.update({{"candidates", report.candidates}, {"filters", filters_json(report)}});
    const nlohmann::ordered_json classes = classes_json(report);
    if (!classes.empty()) stats["classes"] = classes;
    if (report.tolerance) stats["tolerance"] = *report.tolerance;
    if (report.tolerance > 0) stats["undecided_thickness"] = undecided_pairs(report).thick;
    if (report.open_objects > 0) {
        stats["not_closed"] = report.open_objects;
        stats["undecided"] = undecided_pairs(report).open;
    }
    if (!report.unit.empty()) stats["unit"] = report.unit;
    for (const Part& part : report.converted)
        stats["converted"].push_back({{"file", part.path}, {"from", part.converted_from}});
    if (report.elements.with_geometry > 0) stats["elements"] = elements_json(report.elements);
    if (!report.warnings.empty()) stats["warnings"] = report.warnings;
    if (report.changes) {
        const io::ChangeCounts& changes = *report.changes;
        stats.update({{"new", changes.begun}, {"same", changes.same}, {"gone", changes.gone}});
    }
    if (report.statuses) stats["statuses"] = statuses_json(*report.statuses);
    if (report.events) stats.update({{"began", report.events->began}, {"ended", report.events->ended}});
    return stats.dump(2) + '\n';
}

}  // namespace octopair::cli
