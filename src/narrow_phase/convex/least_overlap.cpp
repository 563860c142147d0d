// find_least_overlap(): the direction along which two cores overlap least, by an expanding polytope.
//
// Polytope  The convex hull of points of the difference a - b. It lies within the difference, so the
//           height of its face nearest to the origin is a lower bound on the overlap along every direction.
// Growth    The nearest face is replaced by the difference's farthest point along its normal. If there is no farther one, the
//           overlap along this normal is the least of all.
// Flat      If the difference has no volume, the overlap along its normal is the least.
// Source    G. van den Bergen, "Proximity queries and penetration depth computation on 3D game objects", 2001. Here the
//           polytope need not contain the origin, so neither a first simplex around it nor touching cores are special.
#include "narrow_phase/convex/least_overlap.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <queue>
#include <utility>
#include <vector>

namespace octopair {
namespace {

using vector::cross;
using vector::dot;
using vector::minus;
using vector::times;

constexpr std::size_t max_points = 400;
constexpr double relative_tolerance = 1e-10;

class DifferenceHull {
public:
    DifferenceHull(LeastOverlap& least, double slack) : least_(least), slack_(slack) {}

    /// Makes a tetrahedron of farthest points. Returns false if the difference is flat; then its normal has been tried.
    bool begin() {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            Point3d unit = {};
            unit[axis] = 1;
            try_both(unit);
        }
        const std::size_t first = farthest_from(points_[0]), second = farthest_from(points_[first]);
        const Point3d origin = points_[first], line = minus(points_[second], origin);
        const double length = vector::length(line);
        if (!(length > slack_)) return false;  // a point
        const Point3d along = times(line, 1 / length), across = vector::some_normal(along);
        try_both(across);
        try_both(cross(along, across));
        const std::size_t third =
            farthest([&](const Point3d& point) { return vector::length(cross(along, minus(point, origin))); });
        const Point3d area = cross(along, minus(points_[third], origin));
        if (!(vector::length(area) > slack_)) {  // a segment
            least_.propose(cross(along, origin));
            return false;
        }
        const Point3d normal = times(area, 1 / vector::length(area));
        try_both(normal);
        const auto height = [&](const Point3d& point) { return std::fabs(dot(normal, minus(point, origin))); };
        const std::size_t fourth = farthest(height);
        if (!(height(points_[fourth]) > slack_)) return false;
        make_tetrahedron({std::uint32_t(first), std::uint32_t(second), std::uint32_t(third), std::uint32_t(fourth)});
        return true;
    }

    /// Returns a lower bound on the overlap along every direction: the least height of a face.
    double least_height() {
        skip_removed();
        const double waiting = nearest_.empty() ? std::numeric_limits<double>::infinity() : nearest_.top().first;
        return faces_.empty() ? -waiting : std::min(waiting, least_tried_);
    }

    /// Replaces the nearest face by faces farther from the origin. Returns true if the least overlap was found.
    bool grow() {
        for (skip_removed(); !nearest_.empty(); skip_removed()) {
            const auto [height, face] = nearest_.top();
            const double tolerance = std::max(slack_, relative_tolerance * least_.overlap());
            if (height >= least_.overlap() - tolerance) return true;
            if (points_.size() >= max_points) return false;
            nearest_.pop();
            const Point3d normal = faces_[face].normal;
            points_.push_back(least_.consider(normal));
            if (dot(points_.back(), normal) > height + slack_) add_last_point(face);
            if (!faces_[face].removed) least_tried_ = std::min(least_tried_, height);
        }
        return false;
    }

private:
    /// A face, counterclockwise from outside. `beside[i]` is the face beyond the edge from corner i to the next.
    struct Face {
        std::array<std::uint32_t, 3> corners, beside = {};
        Point3d normal = {};  // 0 for a face without area
        double height = std::numeric_limits<double>::infinity();
        bool removed = false;
        std::size_t reached_from = 0;  // number of points when a new point last saw this face
    };
    struct Edge {
        std::uint32_t from, to;
        std::uint32_t face;  // face beyond the edge; it is not replaced
    };

    void skip_removed() {
        while (!nearest_.empty() && faces_[nearest_.top().second].removed) nearest_.pop();
    }

    void try_both(const Point3d& direction) {
        const Point3d normal = times(direction, 1 / vector::length(direction));
        points_.push_back(least_.consider(normal));
        points_.push_back(least_.consider(times(normal, -1)));
    }

    template <typename Measure>
    std::size_t farthest(const Measure& measure) const {
        std::size_t best = 0;
        double most = -1;
        for (std::size_t i = 0; i < points_.size(); ++i) {
            const double at = measure(points_[i]);
            if (at > most) most = at, best = i;
        }
        return best;
    }
    std::size_t farthest_from(const Point3d& from) const {
        return farthest([&](const Point3d& point) { return vector::length(minus(point, from)); });
    }

    void make_tetrahedron(std::array<std::uint32_t, 4> corners) {
        const Point3d& tip = points_[corners[3]];
        const Point3d base =
            cross(minus(points_[corners[1]], points_[corners[0]]), minus(points_[corners[2]], points_[corners[0]]));
        if (dot(base, minus(tip, points_[corners[0]])) > 0) std::swap(corners[0], corners[1]);
        const auto [a, b, c, d] = corners;
        add_face({a, b, c}, {3, 1, 2});
        add_face({c, b, d}, {0, 3, 2});
        add_face({a, c, d}, {0, 1, 3});
        add_face({b, a, d}, {0, 2, 1});
    }

    std::uint32_t add_face(const std::array<std::uint32_t, 3>& corners, const std::array<std::uint32_t, 3>& beside) {
        const auto number = std::uint32_t(faces_.size());
        faces_.push_back({corners, beside});
        Face& face = faces_.back();
        // The two shorter edges give the most accurate normal.
        std::array<Point3d, 3> edges;
        std::array<double, 3> lengths;
        for (std::size_t i = 0; i < 3; ++i) {
            edges[i] = minus(points_[corners[(i + 1) % 3]], points_[corners[i]]);
            lengths[i] = dot(edges[i], edges[i]);
        }
        const auto longest = std::size_t(std::max_element(lengths.begin(), lengths.end()) - lengths.begin());
        const Point3d area = cross(edges[(longest + 1) % 3], edges[(longest + 2) % 3]);
        const double size = vector::length(area);
        if (!(size * size > 0x1p-90 * lengths[(longest + 1) % 3] * lengths[(longest + 2) % 3])) return number;
        face.normal = times(area, 1 / size);
        face.height = dot(face.normal, points_[corners[0]]);
        nearest_.push({face.height, number});
        return number;
    }

    bool sees_last_point(const Face& face) const {
        const bool has_area = face.height < std::numeric_limits<double>::infinity();
        return !has_area || dot(face.normal, points_.back()) > face.height + slack_;
    }

    /// Replaces the faces that the last point sees by faces between it and their outline. Does nothing if rounding has made
    /// the outline cross itself.
    void add_last_point(std::uint32_t seen) {
        visible_ = {seen};
        outline_.clear();
        faces_[seen].reached_from = points_.size();
        for (std::size_t i = 0; i < visible_.size(); ++i) {
            const Face& face = faces_[visible_[i]];
            for (std::size_t edge = 0; edge < 3; ++edge) {
                Face& other = faces_[face.beside[edge]];
                if (other.reached_from == points_.size()) continue;
                if (sees_last_point(other)) {
                    other.reached_from = points_.size();
                    visible_.push_back(face.beside[edge]);
                }
            }
        }
        for (const std::uint32_t number : visible_) {
            const Face& face = faces_[number];
            for (std::size_t edge = 0; edge < 3; ++edge) {
                if (faces_[face.beside[edge]].reached_from == points_.size()) continue;
                outline_.push_back({face.corners[edge], face.corners[(edge + 1) % 3], face.beside[edge]});
            }
        }
        if (!put_outline_in_order()) return;
        for (const std::uint32_t number : visible_) faces_[number].removed = true;
        fill_outline();
    }

    bool put_outline_in_order() {
        for (std::size_t i = 0; i + 1 < outline_.size(); ++i) {
            std::size_t next = i + 1;
            while (next < outline_.size() && outline_[next].from != outline_[i].to) ++next;
            if (next == outline_.size()) return false;
            std::swap(outline_[i + 1], outline_[next]);
        }
        return outline_.size() >= 3 && outline_.back().to == outline_.front().from;
    }

    void fill_outline() {
        const auto tip = std::uint32_t(points_.size() - 1);
        const auto first = std::uint32_t(faces_.size()), count = std::uint32_t(outline_.size());
        for (std::uint32_t i = 0; i < count; ++i) {
            const Edge& edge = outline_[i];
            const std::uint32_t number = add_face(
                {edge.from, edge.to, tip}, {edge.face, first + (i + 1) % count, first + (i + count - 1) % count});
            Face& outer = faces_[edge.face];
            for (std::size_t k = 0; k < 3; ++k) {
                if (outer.corners[k] == edge.to && outer.corners[(k + 1) % 3] == edge.from) outer.beside[k] = number;
            }
        }
    }

    using Nearest = std::pair<double, std::uint32_t>;  // height and face

    LeastOverlap& least_;
    double slack_;
    std::vector<Point3d> points_;
    std::vector<Face> faces_;
    std::priority_queue<Nearest, std::vector<Nearest>, std::greater<>> nearest_;  // faces whose normals were not tried
    double least_tried_ = std::numeric_limits<double>::infinity();                // of tried faces that are still there
    std::vector<std::uint32_t> visible_;
    std::vector<Edge> outline_;
};

}  // namespace

double find_least_overlap(LeastOverlap& least, double slack) {
    DifferenceHull hull(least, slack);
    if (!hull.begin()) return -std::numeric_limits<double>::infinity();
    const bool found = hull.grow();
    const double at_least = hull.least_height() - slack;
    if (!found) least.descend();
    return at_least;
}

}  // namespace octopair
