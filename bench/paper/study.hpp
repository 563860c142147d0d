// The measurements of the paper's section 5, here: time by number of objects and of processors, for the paper's algorithm
// as published and for octopair.
//
// All setups of a number of objects take turns, round by round, so that what else the machine does meets them alike. The
// first run of each is not counted. The paper's algorithm runs at its best fixed depth for the scene, and sorts by
// octopair's radix sort; at the largest number of objects and of processors also by std::sort, as the paper does by qsort.
//
// Source: Lucchesi, Egbert, Harris 2014, section 5 (figure 5, tables 1 and 2, component times).
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "paper/fit.hpp"

namespace octopair::paper {

struct StudyPlan {
    std::string scene = "uniform";       ///< a kind of samples/scenes.hpp, seed 1
    std::vector<std::uint64_t> objects;  ///< ascending, each once, at least 2
    unsigned threads = 1;                ///< the most processors, at least 1
    unsigned rounds = 7;
    double most_seconds = 20;  ///< after which a setup rests for a number of objects, but not before 3 rounds
};

enum class Finder : std::uint8_t { paper, paper_standard_sort, octopair };

/// Who finds the pairs, and on what.
struct Setup {
    Finder finder = Finder::octopair;
    unsigned machines = 1;                ///< as the paper's algorithm sees them: it merges on each first
    unsigned processors_per_machine = 1;  ///< threads
    unsigned processors() const { return machines * processors_per_machine; }
};

/// "1", or "2 x 2" for machines of several processors.
std::string processors_text(const Setup& setup);
/// "paper", "paper, std::sort", "octopair".
std::string_view finder_text(Finder finder);

/// Wall-clock seconds of the steps; the slowest where several work side by side.
struct Steps {
    double encode = 0, sort = 0;
    double merge = 0;         ///< the paper's: on each machine
    double merge_master = 0;  ///< the paper's alone
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
    unsigned level = 0;  ///< of the paper's octree; 0 for octopair
    std::vector<Run> runs;

    std::vector<double> seconds() const;
    double median_seconds() const { return median(seconds()); }
    /// The median of each step by itself.
    Steps median_steps() const;
};

struct Series {
    Setup setup;
    std::vector<Point> points;  ///< ascending by objects

    /// Null where there is none.
    const Point* point(std::uint64_t objects) const;
    Fits fits() const;
};

struct Study {
    StudyPlan plan;
    std::vector<Series> series;
};

/// What is run on up to `threads` processors: 1 to 4, then doubled, and `threads`; for 4 and more that are even, the paper's
/// algorithm also as machines of two. The paper's with std::sort is for the largest number of objects alone.
std::vector<Setup> setups(unsigned threads);

/// Receives what is being done, and how much of all is done, 0 to 1.
using StudyProgress = std::function<void(std::string_view activity, double done)>;

/// Throws Error{engine_failed} if two setups find different numbers of pairs, Error{cancelled} after a stop request: at once
/// in octopair's runs, after the run in the paper's. Memory: that of the paper's algorithm, which holds all octants that a
/// box meets.
Study measure(const StudyPlan& plan, const StudyProgress& progress, const std::stop_token& stop);

}  // namespace octopair::paper
