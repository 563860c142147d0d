// CGAL's Polygon_mesh_processing::self_intersections, with the kernel of exact predicates. GPL: here alone, never in what is
// shipped.
#pragma once

#include <memory>
#include <vector>

#include "octopair/objects.hpp"
#include "octopair/shapes.hpp"

namespace octopair::bench {

class CgalSelfIntersections {
public:
    /// Makes CGAL's own mesh, which is not in the time of a run.
    explicit CgalSelfIntersections(const shape::Mesh& mesh);
    ~CgalSelfIntersections();

    /// In CGAL's order, in which either number may be the lower. 1 thread: its sequential algorithm.
    std::vector<Pair> run(unsigned threads) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace octopair::bench
