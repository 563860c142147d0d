#include "narrow_phase/thickness/overlap_thickness.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "narrow_phase/exact/triangle_pair.hpp"
#include "narrow_phase/mesh/mesh_probe.hpp"
#include "narrow_phase/thickness/open_overlap.hpp"
#include "narrow_phase/thickness/outer_mesh.hpp"
#include "narrow_phase/thickness/overlap_surface.hpp"
#include "narrow_phase/thickness/plank.hpp"
#include "narrow_phase/thickness/plank_cover.hpp"

namespace octopair {

namespace {

constexpr std::size_t max_boxes = 5000;          // that a search for a proof examines
constexpr std::size_t max_boxes_for_balls = 64;  // that it examines after it failed
constexpr std::size_t max_pieces = 96;           // boxes with more pieces are divided at once

struct SearchBox {
    Box3d box;
    NearLists near;

    double length(std::size_t axis) const { return box.max[axis] - box.min[axis]; }
    double longest() const { return std::max({length(0), length(1), length(2)}); }
    bool operator<(const SearchBox& other) const { return longest() < other.longest(); }
};

/// The triangles and the slopes that the search found around a box.
struct Surroundings {
    NearLists near;              ///< triangles that count in the box
    Point3d slopes = {1, 1, 1};  ///< for each axis, the greatest coordinate of a piece's normal
};

class ThicknessSearch {
public:
    ThicknessSearch(const PosedMesh& a, const PosedMesh& b, double tolerance, const std::stop_token& stop)
        : tolerance_(tolerance), stop_(stop), surface_(a, b, tolerance), probes_{SurfaceProbe(a), SurfaceProbe(b)} {}

    OverlapThickness run() {
        // Rounding must be small beside the tolerance; and boxes beyond the range of float32 are not known.
        if (!(surface_.rounding() <= tolerance_ / 1024)) return {ThicknessKind::undecided, 0};
        // Most thick overlaps have a thick ball in the middle.
        test_ball(middle_of(surface_.common_box()));
        if (found_ > tolerance_) return {ThicknessKind::at_least, found_};
        surface_.find_triangles();
        // Depth first: a box that cannot be decided ends the search for a proof soon.
        std::vector<SearchBox> waiting;
        waiting.push_back({surface_.common_box(), surface_.all_near()});
        bool proven = true;
        for (std::size_t examined = 0; !waiting.empty(); ++examined) {
            if (stop_.stop_requested()) break;
            if (proven && examined == max_boxes) proven = false;
            if (!proven) {
                // The boxes that remain may still have a thick ball. The largest boxes come first.
                if (examined == max_boxes + max_boxes_for_balls) break;
                std::iter_swap(std::max_element(waiting.begin(), waiting.end()), waiting.end() - 1);
            }
            const SearchBox at = std::move(waiting.back());
            waiting.pop_back();
            Surroundings around;
            if (is_thin(at, around)) continue;
            if (found_ > tolerance_ || pierced_) return {ThicknessKind::at_least, found_};
            if (at.longest() > tolerance_ / 8) {
                divide(at, around, waiting);
            } else if (proven) {
                proven = false;
                examined = max_boxes;
            }
        }
        return {proven ? ThicknessKind::at_most : ThicknessKind::undecided, proven ? thickest_ : found_};
    }

private:
    /// Returns true if no ball thicker than the tolerance has its centre in the box, and the overlap opens there. Describes what is around
    /// the box.
    bool is_thin(const SearchBox& at, Surroundings& around) {
        // All ends of lines that open a point of the box are within the tolerance of it.
        const Box3d wide = grown(at.box, tolerance_ + surface_.rounding());
        FoundPieces all;
        const bool few = surface_.find_pieces(wide, at.near, max_pieces, all);
        around.near = all.near;
        if (!few) {
            test_ball(middle_of(at.box));
            return false;
        }
        around.slopes = slopes_of(all.pieces);
        const OpenRequest open{surface_, all.pieces, tolerance_ + surface_.rounding()};
        const double reach = tolerance_ / 2 + surface_.rounding();
        ConvexDomain rounded = rounded_domain(at.box, reach);
        FoundPieces found;
        if (!surface_.find_pieces(rounded.box, around.near, 2 * max_pieces, found)) return false;
        if (has_cover(at.box, {rounded.box}, found.pieces, open) || is_along_piece(at.box, open)) return true;
        // In small boxes, much of the box around lies beyond the reach of balls.
        if (at.longest() > 4 * tolerance_) return false;
        cut_off(rounded, found.pieces);
        return has_cover(at.box, rounded, found.pieces, open);
    }

    static Box3d grown(Box3d box, double by) {
        for (std::size_t axis = 0; axis < 3; ++axis) box.min[axis] -= by, box.max[axis] += by;
        return box;
    }

    /// Removes the parts of the pieces outside of the domain.
    static void cut_off(const ConvexDomain& domain, std::vector<Piece>& pieces) {
        for (Piece& piece : pieces) {
            for (const CutPlane& plane : domain.planes) piece.polygon = cut_below(std::move(piece.polygon), plane, 0);
            piece.area = area_of(piece.polygon);
        }
        std::erase_if(pieces, [](const Piece& piece) { return piece.polygon.empty(); });
    }

    /// Returns true if planks cover the overlap in the domain, and it opens in the box. Otherwise looks for a thick ball, and for points that
    /// certainly do not open.
    // NOLINTNEXTLINE(readability-function-size): the first two parameters are a box and the domain around it.
    bool has_cover(const Box3d& box, const ConvexDomain& domain, const std::vector<Piece>& pieces,
                   const OpenRequest& open) {
        const std::vector<Cover> covers = find_covers({surface_, domain, pieces, open.most});
        for (const Cover& cover : covers) {
            if (!cover.found || !opens(open, box, cover.planks)) continue;
            thickest_ = std::max(thickest_, std::min(cover.width, tolerance_));
            return true;
        }
        test_ball(middle_of(box));
        for (const Cover& cover : covers) {
            for (const Point3d& point : cover.in_both) test_ball(point);
        }
        pierced_ |= is_pierced(open, box);
        return false;
    }

    /// Returns true if all points of the box are within half the tolerance of one piece, and the overlap opens in the box.
    bool is_along_piece(const Box3d& box, const OpenRequest& open) {
        const std::vector<Point3d> corners = Polyhedron({box}, surface_.rounding()).corners();
        for (const Piece& piece : open.pieces) {
            double farthest = 0;  // the distance from a convex piece is greatest at a corner of the box
            for (const Point3d& corner : corners) {
                farthest = std::max(farthest, distance_of(corner, piece.polygon));
                if (2 * farthest > tolerance_) break;
            }
            if (2 * farthest > tolerance_) continue;
            const Plank whole{piece.normal, extent_along(piece.normal, {corners})};
            if (!opens(open, box, {&whole, 1})) return false;
            thickest_ = std::max(thickest_, 2 * farthest);
            return true;
        }
        return false;
    }

    static double distance_of(const Point3d& point, const Polygon& polygon) {
        double least = std::numeric_limits<double>::infinity();
        const auto& corners = polygon.corners;
        for (std::size_t i = 2; i < corners.size(); ++i) {
            least = std::min(least, triangle_gap(point, {corners[0], corners[i - 1], corners[i]}));
        }
        return least;
    }

    static Point3d slopes_of(const std::vector<Piece>& pieces) {
        Point3d slopes = {};
        for (const Piece& piece : pieces) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                slopes[axis] = std::max(slopes[axis], std::abs(piece.normal[axis]));
            }
        }
        return slopes;
    }

    /// Updates found_ if a larger ball around the point lies in both solids.
    void test_ball(const Point3d& point) {
        if (!surface_.in_both(point)) return;
        const Point3d place = surface_.world(point);
        double radius = probes_[0].distance(place, found_ / 2);
        radius = std::min(radius, probes_[1].distance(place, found_ / 2));
        found_ = std::max(found_, 2 * radius - surface_.rounding());
    }

    /// Divides a box. Dividing along an axis helps only if some piece is not parallel to it.
    static void divide(const SearchBox& at, const Surroundings& around, std::vector<SearchBox>& waiting) {
        std::size_t axis = 0;
        const auto use = [&](std::size_t i) { return at.length(i) * (around.slopes[i] + 1e-3); };
        for (const std::size_t other : {std::size_t(1), std::size_t(2)}) {
            if (use(other) > use(axis)) axis = other;
        }
        SearchBox low{at.box, around.near}, high{at.box, around.near};
        low.box.max[axis] = high.box.min[axis] = middle_of(at.box)[axis];
        waiting.push_back(std::move(low));
        waiting.push_back(std::move(high));
    }

    double tolerance_;
    const std::stop_token& stop_;
    OverlapSurface surface_;
    std::array<SurfaceProbe, 2> probes_;
    double found_ = 0;     // diameter of the largest ball that was found
    double thickest_ = 0;  // largest sum of the widths of the planks in a box
    bool pierced_ = false;
};

}  // namespace

OverlapThickness overlap_thickness(const PosedMesh& a, const PosedMesh& b, double tolerance,
                                   const std::stop_token& stop) {
    return ThicknessSearch(a, b, tolerance, stop).run();
}

OverlapThickness overlap_thickness(const PosedMesh& mesh, const BoxedSolid& solid, double tolerance,
                                   const std::stop_token& stop) {
    const auto outer = make_outer_mesh(solid.solid, tolerance / 16);
    if (!outer) return {};
    const auto tree = make_mesh_tree(outer->mesh);
    OverlapThickness overlap = overlap_thickness(mesh, {*tree, solid.box.pose}, tolerance, stop);
    if (overlap.kind == ThicknessKind::at_most) return overlap;
    // A ball in the mesh around the solid may reach out of the solid by the error.
    const double certain = std::max(0.0, overlap.thickness - 2 * outer->error);
    if (overlap.thickness > tolerance && certain <= tolerance) overlap.kind = ThicknessKind::undecided;
    overlap.thickness = certain;
    return overlap;
}

}  // namespace octopair
