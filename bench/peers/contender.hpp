// Contender: one way to find all pairs of a set of boxes, as the comparisons run it.
//
// A contender takes the caller's boxes as they are, so that what it needs to make of them first (trees, copies, sorted
// lists) is in its time, as it is in a user's. It keeps its memory from run to run. Each must find the same pairs: touching
// counts, each once; found() tells, by a sum of hashes that does not depend on the order.
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

/// Adds pairs, in any order and either way round.
void add(Found& found, std::span<const Pair> pairs);

class Contender {
public:
    Contender() = default;
    Contender(const Contender&) = delete;
    Contender& operator=(const Contender&) = delete;
    virtual ~Contender() = default;

    /// Chooses what suits the boxes best, before the first run with them; not timed.
    virtual void prepare(std::span<const Box3f>) {}
    /// What is timed: from boxes in memory to pairs in memory.
    virtual void run(std::span<const Box3f> boxes) = 0;
    /// What the last run found.
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
    bool threads;  ///< can use more than one
    bool limit;    ///< what the hardware allows: finds nothing
    std::unique_ptr<Contender> (*make)(unsigned threads);
    std::uint64_t most_objects = any_number;  ///< with more it takes minutes: run only where it is asked for by name
};

/// Ours, the baselines, and every peer that this build has.
std::vector<ContenderKind> contender_kinds();

// A file each; empty where the library is not there.
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
