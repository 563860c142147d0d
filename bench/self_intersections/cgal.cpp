#include "self_intersections/cgal.hpp"

#define CGAL_LINKED_WITH_TBB
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <oneapi/tbb/global_control.h>

#include <iterator>
#include <utility>

namespace octopair::bench {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;

}  // namespace

struct CgalSelfIntersections::State {
    Surface surface;
};

CgalSelfIntersections::CgalSelfIntersections(const shape::Mesh& mesh) : state_(std::make_unique<State>()) {
    std::vector<Surface::Vertex_index> vertices;
    for (const Point3d& at : mesh.vertices) {
        vertices.push_back(state_->surface.add_vertex(Kernel::Point_3(at[0], at[1], at[2])));
    }
    for (const auto& [a, b, c] : mesh.triangles) state_->surface.add_face(vertices[a], vertices[b], vertices[c]);
}

CgalSelfIntersections::~CgalSelfIntersections() = default;

std::vector<Pair> CgalSelfIntersections::run(unsigned threads) const {
    namespace processing = CGAL::Polygon_mesh_processing;
    const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
    std::vector<std::pair<Surface::Face_index, Surface::Face_index>> faces;
    if (threads == 1) {
        processing::self_intersections(state_->surface, std::back_inserter(faces));
    } else {
        processing::self_intersections<CGAL::Parallel_tag>(state_->surface, std::back_inserter(faces));
    }
    std::vector<Pair> pairs;
    pairs.reserve(faces.size());
    for (const auto& [a, b] : faces) pairs.push_back({std::uint32_t(a), std::uint32_t(b)});
    return pairs;
}

}  // namespace octopair::bench
