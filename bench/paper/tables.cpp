#include "paper/tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "paper/published.hpp"

namespace octopair::paper {

namespace {

std::string setup_text(const Setup& setup) {
    return fmt::format("{} on {}", finder_text(setup.finder), processors_text(setup));
}

bool of_figure(const Series& series) { return series.setup.finder != Finder::paper_standard_sort; }

std::string figure_text(const Study& study) {
    std::string text = fmt::format("Figure 5: run time in milliseconds, {}\n\n{:>12}", study.plan.scene, "objects");
    for (const Series& series : study.series) {
        if (of_figure(series)) text += fmt::format("{:>16}", setup_text(series.setup));
    }
    for (const std::uint64_t objects : study.plan.objects) {
        text += fmt::format("\n{:>12}", grouped(objects));
        for (const Series& series : study.series) {
            if (of_figure(series)) text += fmt::format("{:>16.2f}", series.point(objects)->median_seconds() * 1e3);
        }
    }
    return text + '\n';
}

/// Formats a time, its speedup and its efficiency in 36 columns; a dash without a time.
std::string speedup_cells(const std::optional<TimedRun>& run, double serial_seconds) {
    if (!run) return fmt::format("{:>36}", "-");
    if (run->processors == 1) return fmt::format("{:>14}{:>10}{:>12}", microseconds(run->seconds), "-", "-");
    const Speedup speedup = speedup_of(*run, serial_seconds);
    return fmt::format("{:>14}{:>10.2f}{:>11.1f}%", microseconds(run->seconds), speedup.speedup,
                       speedup.efficiency * 100);
}

/// Times of one table by processors: the paper's figures, its algorithm on this machine, and octopair.
class SpeedupTable {
public:
    SpeedupTable(const Study& study, std::uint64_t objects) : study_(study), objects_(objects) {}

    std::string text() const {
        const std::span<const PublishedTime> published = published_times(objects_);
        const auto number = std::find_if(published_tables.begin(), published_tables.end(),
                                         [&](const PublishedTable& table) { return table.objects == objects_; }) -
                            published_tables.begin();
        std::string text = published.empty() ? "Run time" : fmt::format("Table {}: run time", number + 1);
        text += fmt::format(" in microseconds, {} objects\n\n", grouped(objects_));
        text += fmt::format("{:>10}{:>36}{:>36}{:>36}\n", "", "as published", "the paper's algorithm here", "octopair");
        text += fmt::format("{:>10}", "processors");
        for (int i = 0; i < 3; ++i) text += fmt::format("{:>14}{:>10}{:>12}", "run time", "speedup", "efficiency");
        for (const Setup& setup : rows()) text += '\n' + row(setup);
        return text + '\n';
    }

private:
    /// Returns one row for each measured or published number of processors. Setups of several machines have their own
    /// rows.
    std::vector<Setup> rows() const {
        std::vector<Setup> rows;
        rows.reserve(study_.series.size() + published_times(objects_).size());
        for (const Series& series : study_.series) {
            if (series.setup.finder == Finder::paper) rows.push_back(series.setup);
        }
        for (const PublishedTime& time : published_times(objects_)) {
            const bool there = std::any_of(rows.begin(), rows.end(), [&](const Setup& setup) {
                return setup.machines == 1 && setup.processors() == time.processors;
            });
            if (!there) rows.push_back({Finder::paper, 1, time.processors});
        }
        std::stable_sort(rows.begin(), rows.end(),
                         [](const Setup& a, const Setup& b) { return a.processors() < b.processors(); });
        return rows;
    }

    std::string row(const Setup& setup) const {
        return fmt::format("{:>10}", processors_text(setup)) + speedup_cells(published(setup), published_serial()) +
               measured_cells(setup) + measured_cells({Finder::octopair, setup.machines, setup.processors_per_machine});
    }

    std::optional<TimedRun> published(const Setup& setup) const {
        if (setup.machines > 1) return {};
        for (const PublishedTime& time : published_times(objects_)) {
            if (time.processors == setup.processors())
                return TimedRun{double(time.microseconds) / 1e6, time.processors};
        }
        return {};
    }

    double published_serial() const {
        const auto times = published_times(objects_);
        return times.empty() ? 0 : double(times.front().microseconds) / 1e6;
    }

    std::optional<TimedRun> measured(const Setup& setup) const {
        for (const Series& series : study_.series) {
            const Setup& other = series.setup;
            if (other.finder == setup.finder && other.machines == setup.machines &&
                other.processors_per_machine == setup.processors_per_machine) {
                return TimedRun{series.point(objects_)->median_seconds(), setup.processors()};
            }
        }
        return {};
    }

    std::string measured_cells(const Setup& setup) const {
        return speedup_cells(measured(setup), measured({setup.finder, 1, 1})->seconds);
    }

    const Study& study_;
    std::uint64_t objects_;
};

/// One column of the components.
struct Column {
    std::string head;
    std::optional<Steps> steps;  // none: the published times
};

std::vector<Column> component_columns(const Study& study) {
    std::vector<Column> columns = {{"as published", {}}};
    columns.reserve(study.series.size() + 1);
    for (const Series& series : study.series) {
        if (series.setup.machines > 1 || series.setup.processors() != study.plan.threads) continue;
        columns.push_back({std::string(finder_text(series.setup.finder)), series.points.back().median_steps()});
    }
    return columns;
}

struct Component {
    std::string_view name;
    std::optional<std::uint64_t> published;
    double Steps::*seconds;
};

std::string components_text(const Study& study) {
    const PublishedComponents& published = published_components;
    const Component components[] = {{"octal codes (encode)", published.octal_codes, &Steps::encode},
                                    {"sort", published.sort, &Steps::sort},
                                    {"merge (each machine)", published.merge_machine, &Steps::merge},
                                    {"merge at the master", published.merge_master, &Steps::merge_master},
                                    {"scan", {}, &Steps::scan}};
    const std::vector<Column> columns = component_columns(study);
    std::string text = fmt::format("Components in microseconds, {} objects on {} processor(s); as published: on {}\n\n",
                                   grouped(study.plan.objects.back()), study.plan.threads, published.processors);
    text += fmt::format("{:<22}", "");
    for (const Column& column : columns) text += fmt::format("{:>18}", column.head);
    for (const Component& component : components) {
        text += fmt::format("\n{:<22}", component.name);
        for (const Column& column : columns) {
            const std::string given = component.published ? grouped(*component.published) : "-";
            text += fmt::format("{:>18}", column.steps ? microseconds((*column.steps).*component.seconds) : given);
        }
    }
    return text + '\n';
}

std::string fit_cells(const Fit& fit) { return fmt::format("{:>14.2f}{:>9.1f}%", fit.a * 1e9, fit.residual * 100); }

std::string fits_text(const Study& study) {
    std::string text = "Least squares: a in nanoseconds, the residual relative to the time\n\n";
    text += fmt::format("{:<22}{:>24}{:>24}\n", "", "t = a n", "t = a n log2 n");
    text += fmt::format("{:<22}{:>14}{:>10}{:>14}{:>10}{:>10}   {}", "", "a", "residual", "a", "residual", "spread",
                        "holds better");
    for (const Series& series : study.series) {
        if (!of_figure(series)) continue;
        const Fits fits = series.fits();
        text += fmt::format("\n{:<22}{}{}{:>9.1f}%   {}", setup_text(series.setup), fit_cells(fits.linear),
                            fit_cells(fits.n_log_n), fits.spread * 100, growth_text(fits.growth));
    }
    return text + '\n';
}

}  // namespace

std::string grouped(std::uint64_t number) {
    std::string text = std::to_string(number);
    for (std::size_t at = text.size(); at > 3; at -= 3) text.insert(at - 3, 1, ',');
    return text;
}

std::string microseconds(double seconds) { return grouped(std::uint64_t(std::llround(seconds * 1e6))); }

Speedup speedup_of(const TimedRun& run, double serial_seconds) {
    const double speedup = serial_seconds / run.seconds;
    return {speedup, speedup / run.processors};
}

std::vector<std::uint64_t> table_objects(const Study& study) {
    std::vector<std::uint64_t> objects;
    std::copy_if(study.plan.objects.begin(), study.plan.objects.end(), std::back_inserter(objects),
                 [](std::uint64_t n) { return !published_times(n).empty(); });
    if (objects.empty()) objects.push_back(study.plan.objects.back());
    return objects;
}

std::string study_text(const Study& study) {
    std::string text = figure_text(study);
    for (const std::uint64_t objects : table_objects(study)) text += '\n' + SpeedupTable(study, objects).text();
    return text + '\n' + components_text(study) + '\n' + fits_text(study);
}

}  // namespace octopair::paper
