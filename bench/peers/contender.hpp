// Contender: one way to find all pairs of a set of boxes, for the comparisons.
//
// A contender takes the caller's boxes unchanged, so its time includes building trees, copies and sorted lists, like a
// user's time. Each contender keeps its memory from run to run. All contenders must find equal pairs: touching counts,
// and each pair counts once. found() verifies this by a sum of hashes that does not depend on the order.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "octopair/objects.hpp"

namespace octopair::bench {

struct Found {
    std::uint64_t pairs = 0;
    std::uint64_t hash = 0;
    bool operator==(const Found&) const = default;
};

/// Adds pairs, in any order, as (a, b) or (b, a).
void add(Found& found, std::span<const Pair> pairs);

class Contender {
public:
    Contender() = default;
    Contender(const Contender&) = delete;
    Contender& operator=(const Contender&) = delete;
    virtual ~Contender() = default;

    /// Selects the best settings for the boxes before the first run. Not timed.
    virtual void prepare(std::span<const Box3f>) {}
    /// Finds the pairs, from boxes in memory to pairs in memory. This call is timed.
    virtual void run(std::span<const Box3f> boxes) = 0;
    /// Returns the number and the hash of the pairs of the last run.
    virtual Found found() const = 0;
};

/// Collects pairs in one list.
class CollectingContender : public Contender {
public:
    Found found() const override;

protected:
    std::vector<Pair> pairs_;
};

inline constexpr std::uint64_t any_number = std::numeric_limits<std::uint64_t>::max();

struct ContenderKind {
    std::string name;
    bool threads;  ///< true: can use several threads
    bool limit;    ///< true: measures a hardware limit, finds no pairs
    std::unique_ptr<Contender> (*make)(unsigned threads);
    std::uint64_t max_objects = any_number;  ///< larger scenes take minutes, and run only if selected by name
};

/// Returns octopair, the baselines, and every peer in this build.
std::vector<ContenderKind> contender_kinds();

// Contenders of each library, one source file each.
std::vector<ContenderKind> octopair_contenders();
std::vector<ContenderKind> baseline_contenders();
std::vector<ContenderKind> boost_contenders();
std::vector<ContenderKind> bullet_contenders();
std::vector<ContenderKind> cgal_contenders();
std::vector<ContenderKind> embree_contenders();
std::vector<ContenderKind> fcl_contenders();
std::vector<ContenderKind> limits();
std::vector<ContenderKind> ode_contenders();

}  // namespace octopair::bench
