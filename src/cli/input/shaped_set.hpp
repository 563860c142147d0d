// The shapes of an input set, made ready for the pipeline.
#pragma once

#include <stop_token>
#include <vector>

#include "cli/input/input_set.hpp"
#include "octopair/filters.hpp"

namespace octopair::cli {

class ShapedSet {
public:
    /// Makes shapes ready on so many threads; 0: one a core. Throws what Geometry throws, and Error{cancelled}.
    ShapedSet(io::LoadedShapes loaded, unsigned threads, const std::stop_token& stop);
    ShapedSet(const ShapedSet&) = delete;
    ShapedSet& operator=(const ShapedSet&) = delete;

    // All borrowed.

    ShapedObjects objects(std::span<const double> padding = {}) const;
    /// Empty, or what the files say.
    std::span<const double> padding() const { return loaded_.padding; }
    std::span<const std::uint32_t> parents() const { return loaded_.parents; }
    bool has_planes() const;
    bool has_groups() const { return !loaded_.groups.empty() || !loaded_.masks.empty(); }
    /// With the defaults where the files say nothing.
    GroupMasks group_masks();

private:
    void prepare(std::vector<shape::Any> shapes, unsigned threads, const std::stop_token& stop);

    io::LoadedShapes loaded_;
    std::vector<Geometry> geometries_;
};

/// Takes the shapes of a set that has some; they give it its boxes, if it lacks these, and its padding. Triangles give
/// boxes. Throws as ShapedSet does, and Error{bad_input} for poses that do not fit their shapes, with the file where there
/// is but one.
void make_shaped(InputSet& set, unsigned threads, const std::stop_token& stop);

/// Takes the shapes of both sets of a join; the second may be empty. A plane gets a box that reaches as far as the other set.
/// Throws as for one set.
void make_shaped(InputSet& first, InputSet& second, unsigned threads, const std::stop_token& stop);

}  // namespace octopair::cli
