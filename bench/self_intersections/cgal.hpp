// CGAL's Polygon_mesh_processing::self_intersections, with the kernel of exact predicates. GPL: used only here, never
// in installed code.
#pragma once

#include <memory>
#include <vector>

#include "octopair/objects.hpp"
#include "octopair/shapes.hpp"

namespace octopair::bench {

class CgalSelfIntersections {
public:
    /// Makes CGAL's own mesh. This time is not part of a run.
    explicit CgalSelfIntersections(const shape::Mesh& mesh);
    ~CgalSelfIntersections();

    /// Returns pairs in CGAL's order; either number of a pair may be the lower. With 1 thread, runs CGAL's sequential
    /// algorithm.
    std::vector<Pair> run(unsigned threads) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace octopair::bench
