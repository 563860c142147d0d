// ShapedSet: the shapes of an input set, prepared for the pipeline.
#pragma once

#include <stop_token>
#include <vector>

#include "cli/input/input_set.hpp"
#include "octopair/filters.hpp"

namespace octopair::cli {

struct HowToPrepare {
    unsigned threads = 0;
    /// Maximum distance at which octopair::weld joins vertices of a mesh, as a length in the world; 0: meshes are not changed.
    double weld = 0;
};

class ShapedSet {
public:
    /// Prepares the shapes on `how.threads` threads; 0 means one per core.
    /// Throws: what Geometry throws; Error{cancelled}.
    ShapedSet(io::LoadedShapes loaded, const HowToPrepare& how, const std::stop_token& stop);
    ShapedSet(const ShapedSet&) = delete;
    ShapedSet& operator=(const ShapedSet&) = delete;

    // All returned spans, also those in ShapedObjects and GroupMasks, borrow from this ShapedSet.

    ShapedObjects objects(std::span<const double> padding = {}) const;
    /// Returns the paddings that the files give; empty if they give none.
    std::span<const double> padding() const { return loaded_.padding; }
    std::span<const std::uint32_t> parents() const { return loaded_.parents; }
    bool has_planes() const;
    /// Returns the objects whose geometry is not closed (Geometry::closed).
    std::vector<std::uint32_t> open_objects() const;
    bool has_groups() const { return !loaded_.groups.empty() || !loaded_.masks.empty(); }
    /// Returns the groups and masks of all objects, with defaults for objects without any.
    GroupMasks group_masks();

private:
    void prepare(std::vector<shape::Any> shapes, const HowToPrepare& how, const std::stop_token& stop);
    std::vector<double> scales(std::size_t shapes) const;

    io::LoadedShapes loaded_;
    std::vector<Geometry> geometries_;
};

/// Moves the shapes of `set` into `set.shaped`. Sets the padding of the set, and computes its boxes if it has none. For a set
/// of triangles, only computes the boxes.
/// Throws: what ShapedSet throws; Error{bad_input} for poses that do not fit their shapes. The message begins with the file if
/// the set has only one.
void make_shaped(InputSet& set, const HowToPrepare& how, const std::stop_token& stop);

/// Calls make_shaped() for both sets of a join. `second` may be empty. A plane gets a box that encloses the extent of the other set.
/// Throws: what make_shaped() of one set throws.
void make_shaped(InputSet& first, InputSet& second, const HowToPrepare& how, const std::stop_token& stop);

}  // namespace octopair::cli
