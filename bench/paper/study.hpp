// Measurements of the paper's section 5 on this machine: time by number of objects and of processors. The contenders
// are the paper's algorithm as published, and octopair.
//
// All setups with one number of objects take turns, round by round, so that other load on the machine affects all
// equally. The first run of each setup is not counted. The paper's algorithm runs at its best fixed depth for the
// scene, with octopair's radix sort. With most objects and most processors it also runs with std::sort, where the paper
// uses qsort.
//
// Source: Lucchesi, Egbert, Harris 2014, section 5 (figure 5, tables 1 and 2, component times).
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "machine/median.hpp"
#include "paper/fit.hpp"

namespace octopair::paper {

struct StudyPlan {
    std::string scene = "uniform";       ///< kind of samples/scenes.hpp, seed 1
    std::vector<std::uint64_t> objects;  ///< ascending, without repeats, each at least 2
    unsigned threads = 1;                ///< largest number of processors, at least 1
    unsigned rounds = 7;
    double max_seconds = 20;  ///< time limit of a setup per number of objects, after 3 rounds at least
};

enum class Finder : std::uint8_t { paper, paper_standard_sort, octopair };

/// Algorithm and processors of a measurement.
struct Setup {
    Finder finder = Finder::octopair;
    unsigned machines = 1;                ///< machines of the paper's algorithm; each merges before the master
    unsigned processors_per_machine = 1;  ///< threads
    unsigned processors() const { return machines * processors_per_machine; }
};

/// Returns "1", or "2 x 2" for machines of several processors.
std::string processors_text(const Setup& setup);
/// Returns "paper", "paper, std::sort" or "octopair".
std::string_view finder_text(Finder finder);

/// Wall-clock seconds of the steps. If several processors work in parallel: seconds of the slowest. For octopair, `sort`
/// is the step scatter, and `merge` is the step count.
struct Steps {
    double encode = 0, sort = 0;
    double merge = 0;         ///< paper's algorithm: on each machine
    double merge_master = 0;  ///< paper's algorithm only: at the master
    double scan = 0;
};

struct Run {
    double seconds = 0;  ///< from boxes in memory to pairs in memory
    Steps steps;
};

/// One setup with one number of objects.
struct Point {
    std::uint64_t objects = 0;
    std::uint64_t pairs = 0;
    unsigned level = 0;  ///< depth of the paper's octree; 0 for octopair
    std::vector<Run> runs;

    std::vector<double> seconds() const;
    double median_seconds() const { return bench::median(seconds()); }
    /// Returns the median of each step, computed separately.
    Steps median_steps() const;
};

struct Series {
    Setup setup;
    std::vector<Point> points;  ///< ascending by objects

    /// Returns the point with this number of objects, or null.
    const Point* point(std::uint64_t objects) const;
    Fits fits() const;
};

struct Study {
    StudyPlan plan;
    std::vector<Series> series;
};

/// Returns the setups on up to `threads` processors: 1 to 4, then doubled, and `threads`. For even numbers from 4 on,
/// the paper's algorithm also runs as machines of two. Its variant with std::sort runs only with most objects.
std::vector<Setup> setups(unsigned threads);

/// Receives the current activity and the completed part, 0 to 1.
using StudyProgress = std::function<void(std::string_view activity, double done)>;

/// Runs all measurements of a plan. Throws: Error{engine_failed} if two setups find different numbers of pairs;
/// Error{cancelled} after a stop request. Then a run of octopair stops at once, and a run of the paper's algorithm
/// completes. Memory: the paper's algorithm holds all octants that each box meets.
Study measure(const StudyPlan& plan, const StudyProgress& progress, const std::stop_token& stop);

/// Returns the study as one JSON object (docs/formats.md), ended by a newline: every measured time, and derived quantities (json.cpp).
std::string study_json(const Study& study);

}  // namespace octopair::paper
