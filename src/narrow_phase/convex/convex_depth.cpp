// How deep convex things meet.
//
// For any direction, what the two overlap along it is a depth that parts them, by their supports alone; the least of all
// directions is wanted. Cores that do not meet have it along their shortest way. Of cores that do, libccd's expanding
// polytope proposes one, as do the axes, edges and faces that the two show, for it gives up on flat ones; the best
// proposal is then followed downhill. So what a library gets wrong can cost depth, but a contact always parts the two.
#include <ccd/ccd.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "geometry/vector.hpp"
#include "narrow_phase/convex/local_convex.hpp"

namespace octopair {
namespace {

/// libccd's tolerances are absolute, so it sees the pair scaled to this size. Its polytope of a pair that touches may grow
/// for ever; after so many questions it is told of the origin alone, beyond which there is nothing to grow to.
struct Scaled {
    const LocalConvex* convex;
    double scale;
    mutable int questions = 256;
};

void support_scaled(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* farthest) {
    const auto& scaled = *static_cast<const Scaled*>(object);
    if (scaled.questions-- <= 0) return ccdVec3Set(farthest, 0, 0, 0);
    const Point3d point = scaled.convex->support({direction->v[0], direction->v[1], direction->v[2]});
    ccdVec3Set(farthest, point[0] * scaled.scale, point[1] * scaled.scale, point[2] * scaled.scale);
}

/// The best direction so far.
class LeastOverlap {
public:
    explicit LeastOverlap(const LocalConvexPair& frame) : frame_(frame) {}

    void propose(const Point3d& direction) {
        const double length = vector::length(direction);
        if (!(length > 0) || !std::isfinite(length)) return;
        const Point3d normal = {direction[0] / length, direction[1] / length, direction[2] / length};
        consider(normal);
        consider(vector::times(normal, -1));
    }

    /// TicketLock the direction against the way that is not along it, as long as that makes the overlap less.
    void descend() {
        double step = 1;
        for (int i = 0; i < 64 && step > 1e-9; ++i) {
            const Point3d aside = vector::minus(vertex_, vector::times(normal_, vector::dot(vertex_, normal_)));
            const double length = vector::length(vertex_), before = overlap_;
            if (!(length > 0)) return;
            const Point3d turned = vector::minus(normal_, vector::times(aside, step / length));
            const double size = vector::length(turned);
            if (size > 0) consider(vector::times(turned, 1 / size));
            step = overlap_ < before ? std::min(1.0, step * 1.5) : step / 4;
        }
    }

    const Point3d& normal() const { return normal_; }
    /// With the radii; below 0 of two that are apart along the normal.
    double overlap() const { return overlap_ + frame_.radii(); }
    const Point3d& on_a() const { return on_a_; }
    const Point3d& on_b() const { return on_b_; }

private:
    void consider(const Point3d& normal) {
        const Point3d on_a = frame_.a().support(normal), on_b = frame_.b().support(vector::times(normal, -1));
        const Point3d vertex = vector::minus(on_a, on_b);
        const double overlap = vector::dot(vertex, normal);
        if (!(overlap < overlap_)) return;
        overlap_ = overlap, normal_ = normal, vertex_ = vertex, on_a_ = on_a, on_b_ = on_b;
    }

    const LocalConvexPair& frame_;
    double overlap_ = std::numeric_limits<double>::infinity();
    Point3d normal_ = {1, 0, 0}, vertex_ = {}, on_a_ = {}, on_b_ = {};
};

void propose_by_polytope(const LocalConvexPair& frame, LeastOverlap& least) {
    const double size = frame.a().magnitude() + frame.b().magnitude();
    if (!std::isfinite(1 / size)) return;  // nor are there digits for a polytope
    const Scaled a = {&frame.a(), 1 / size}, b = {&frame.b(), 1 / size};
    ccd_t settings;
    CCD_INIT(&settings);
    settings.support1 = settings.support2 = support_scaled;
    settings.max_iterations = 200;
    // Of a difference of squares: with 1e-8, what is left of a small depth is wrong by a tenth.
    settings.epa_tolerance = 1e-11;
    ccd_real_t depth = 0;
    ccd_vec3_t way, place;
    if (ccdGJKPenetration(&a, &b, &settings, &depth, &way, &place) == 0) least.propose({way.v[0], way.v[1], way.v[2]});
}

/// Directions that a core shows: its axes and, of few points, its edges.
std::vector<Point3d> edges_of(const LocalConvex& convex) {
    std::vector<Point3d> edges;
    const auto points = convex.points();
    for (std::size_t i = 0; i < points.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) edges.push_back(vector::minus(points[i], points[j]));
    }
    if (!points.empty()) return edges;
    for (std::size_t axis = 0; axis < 3; ++axis) edges.push_back(vector::column(convex.pose(), axis));
    return edges;
}

/// Across the two longest ways inside: the normal of a flat one.
Point3d thin_way(const LocalConvex& convex) {
    const Point3d from = convex.middle();
    Point3d along = {}, across = {};
    double longest = 0, widest = 0;
    for (const bool second : {false, true}) {
        for (const Point3d& probe : {Point3d{1, 0, 0}, Point3d{0, 1, 0}, Point3d{0, 0, 1}, Point3d{1, 1, 1}}) {
            for (const double sign : {1.0, -1.0}) {
                const Point3d way = vector::minus(convex.support(vector::times(probe, sign)), from);
                const Point3d area = vector::cross(along, way);
                if (!second && vector::length(way) > longest) longest = vector::length(way), along = way;
                if (second && vector::length(area) > widest) widest = vector::length(area), across = area;
            }
        }
    }
    return across;
}

void propose_by_features(const LocalConvexPair& frame, LeastOverlap& least) {
    const Point3d between = vector::minus(frame.b().middle(), frame.a().middle());
    least.propose({1, 0, 0});
    least.propose(between);
    const std::vector<Point3d> edges_a = edges_of(frame.a()), edges_b = edges_of(frame.b());
    for (const auto* edges : {&edges_a, &edges_b}) {
        for (const Point3d& edge : *edges) {
            least.propose(edge);
            least.propose(vector::cross(edge, vector::cross(between, edge)));
        }
        for (std::size_t i = 0; i < edges->size(); ++i) {
            for (std::size_t j = 0; j < i; ++j) least.propose(vector::cross((*edges)[i], (*edges)[j]));
        }
    }
    for (const Point3d& a : edges_a) {
        for (const Point3d& b : edges_b) least.propose(vector::cross(a, b));
    }
    least.propose(thin_way(frame.a()));
    least.propose(thin_way(frame.b()));
}

/// Along the way between the cores, the middle of what is within both radii; of cores that meet, a point in both.
Point3d point_in_both(const LocalConvexPair& frame, const CoreGap& core) {
    const Point3d way = vector::minus(core.on_b, core.on_a);
    const double length = vector::length(way);
    if (!(length > 0)) return core.on_a;
    const double begin = std::max(0.0, length - frame.b().radius()), end = std::min(length, frame.a().radius());
    return vector::plus(core.on_a, vector::times(way, (begin + end) / 2 / length));
}

}  // namespace

ConvexContact convex_contact(const PosedConvex& a, const PosedConvex& b) {
    const LocalConvexPair frame(a, b);
    const CoreGap core = core_gap(frame);
    LeastOverlap least(frame);
    const Point3d way = vector::minus(core.on_b, core.on_a);
    // A way as short as rounding has no direction.
    if (core.at_least > 0 && core.at_most > 1e4 * frame.slack()) {
        least.propose(way);
    } else {
        propose_by_polytope(frame, least);
        propose_by_features(frame, least);
        least.descend();
    }
    const Point3d& normal = least.normal();
    ConvexContact contact;
    contact.depth = std::max(0.0, least.overlap());
    contact.point = vector::plus(point_in_both(frame, core), frame.origin());
    contact.normal = frame.swapped() ? vector::times(normal, -1) : normal;
    return contact;
}

}  // namespace octopair
