// OctreePlan: chooses the space and the octants of a linear octree from a sample of the objects.
// Start here to change when an octant is split.
//
// 1. A sample of the objects is taken: one object of each stride, at a scattered place (octant_sample()).
// 2. The space is fitted to the sample (space.hpp).
// 3. Octants are split, from the root down, as long as SplitRule says so. The result is a Directory.
//
// An octant is split if it is crowded: it holds too many objects, or a sweep along its best axis would test too many. It is
// not split if the split
//   would multiply entries (boxes as large as the octant), or
//   would copy the boxes handed down from above into the children without thinning them.
//
// The thresholds are in base/tuning.hpp (Tuning::Sampling, Tuning::Split).
//
// Decisions depend only on sums over the sampled boxes, and on their least and greatest cells. So parts of a sample can be
// counted separately, and the order of boxes does not matter.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>
#include <utility>
#include <vector>

#include "base/private_export.hpp"
#include "boxes/entry.hpp"
#include "boxes/entry_source.hpp"
#include "octree/plan/directory.hpp"
#include "octree/plan/sample.hpp"
#include "octree/plan/space.hpp"

namespace octopair {

/// An octant and the sampled boxes that touch it.
struct SampledOctant {
    using Boxes = std::vector<CellBox>;
    OctantCube octant;
    Boxes inside;  ///< boxes that fit into the octants below
    Boxes kept;    ///< boxes that this octant or an octant above keeps

    /// Moves the boxes that do not fit into the octants below from `inside` to `kept`. Must be called before divided().
    void keep();
    /// Returns the children and their boxes, before keep() of each child.
    std::array<SampledOctant, 8> divided() const;
};

/// Numbers of sampled boxes in an octant, after keep(), and in the children that a split would make.
struct OctantCounts {
    std::uint64_t inside = 0, kept = 0;
    std::uint64_t beginning = 0;                     ///< boxes of `inside` that begin in the octant
    std::uint64_t inside_below = 0, kept_below = 0;  ///< sums over the children that the boxes touch

    static OctantCounts of(const SampledOctant& sampled, const std::array<SampledOctant, 8>& below);
};

class OCTOPAIR_PRIVATE_EXPORT SplitRule {
public:
    /// `weight`: number of objects that a sampled box represents.
    SplitRule(double weight, std::stop_token stop) : weight_(weight), stop_(std::move(stop)) {}

    /// Returns the number of objects that sampled boxes represent.
    double objects(std::uint64_t boxes) const { return double(boxes) * weight_; }
    /// True if `inside` sampled boxes are too many for one octant, wherever they are in it.
    bool is_crowd(std::uint64_t inside) const;
    bool crowded(const SampledOctant& sampled) const;
    /// True if a sweep on cells of this many sampled boxes would cost too much. `tests`: tests of the sweep for each box.
    bool is_too_large_for_sweep(std::uint64_t boxes, double tests) const;
    /// True if dividing a crowded octant multiplies neither entries nor boxes handed down.
    static bool worth_splitting(const OctantCounts& counts);

    /// Receives a leaf that is crowded, but not worth dividing, and its place in the shape.
    using CrowdSink = std::function<void(const SampledOctant& leaf, std::size_t place)>;
    /// Divides an octant as far as the rule says, and appends the shape of its subtree to `shape`.
    /// Throws: Error{cancelled}.
    void grow(SampledOctant sampled, SplitFlags& shape, const CrowdSink& crowd = {}) const;

    /// Returns an estimate of the number of others that a sweep of the octant along its best axis tests each object against.
    double tests_per_object(const SampledOctant& sampled) const;

private:
    double weight_;
    std::stop_token stop_;
};

/// Returns the positions of the sampled objects, from which the octants of an octree of `objects` objects are chosen.
OCTOPAIR_PRIVATE_EXPORT Sample octant_sample(std::uint64_t objects);
/// Returns the rule that decides, from the objects of octant_sample(), which octants are divided.
OCTOPAIR_PRIVATE_EXPORT SplitRule split_rule(std::uint64_t objects, const std::stop_token& stop);

/// An octree's space and octants. Both are a function of a sample of the objects.
struct OctreeLayout {
    Space space;
    Directory directory;
};

/// Space and shape of an octree, small enough to be sent to other processes.
struct OctreePlan {
    Space space;
    SplitFlags shape;

    OctreeLayout layout() const { return {space, Directory(space, shape)}; }
};
/// Plans an octree of `objects` objects. `sampled`: the entries at the positions octant_sample(objects).
/// Throws: Error{cancelled}.
OCTOPAIR_PRIVATE_EXPORT OctreePlan plan_octree(std::span<const Entry> sampled, std::uint64_t objects,
                                               const std::stop_token& stop);
OCTOPAIR_PRIVATE_EXPORT OctreePlan plan_octree(const EntrySource& source, const std::stop_token& stop);
/// Samples `source`, calls plan_octree(), and returns the layout of this plan.
OCTOPAIR_PRIVATE_EXPORT OctreeLayout make_layout(const EntrySource& source, const std::stop_token& stop);

}  // namespace octopair
