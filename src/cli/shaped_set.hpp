// The shapes of an input set, made ready for the pipeline.
#pragma once

#include <vector>

#include "cli/input_set.hpp"
#include "octopair/shapes.hpp"

namespace octopair::cli {

/// Borrows the shapes of a set that has them.
class ShapedSet {
public:
    /// Throws Error{bad_input} for a shape that is none, with the file where there is but one.
    explicit ShapedSet(const InputSet& set);

    /// Borrowed. The padding is that of the shapes alone.
    ShapedObjects objects() const;

private:
    const io::LoadedShapes& loaded_;
    std::vector<Geometry> geometries_;
};

/// Gives a set its boxes, if it lacks them. Throws as ShapedSet does, and for poses that do not fit their shapes.
void make_boxes(InputSet& set);

/// Both sets of a join anew, where they have shapes that boxes are made of: a plane has to reach as far as the other set.
void make_join_boxes(InputSet& first, InputSet& second);

}  // namespace octopair::cli
