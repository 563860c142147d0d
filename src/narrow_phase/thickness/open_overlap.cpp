#include "narrow_phase/thickness/open_overlap.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace octopair {

namespace {

constexpr double facing = 1e-6;     // cosine: pieces that are closer to perpendicular face neither way
constexpr int max_divisions = 6;    // of a region, into parts of parts
constexpr int max_tests = 200;      // regions and directions that are tested for a box
constexpr int max_approaches = 30;  // steps from the mean of normals to the nearest point of their hull

/// Returns the part of a polygon below all planes; empty if it only touches one of them.
Polygon part_within(const Polygon& polygon, std::span<const CutPlane> planes, double rounding) {
    const auto is_beyond = [&](const CutPlane& plane, const Polygon& part) {
        return extent_along(plane.normal, part).low > plane.offset - rounding;
    };
    // Most polygons are beyond some plane: look before one is copied.
    if (polygon.empty() ||
        std::any_of(planes.begin(), planes.end(), [&](const auto& plane) { return is_beyond(plane, polygon); })) {
        return {};
    }
    Polygon part = polygon;
    for (const CutPlane& plane : planes) {
        part = cut_below(std::move(part), plane, rounding);
        if (part.empty() || is_beyond(plane, part)) return {};
    }
    return part;
}

/// Part of a piece on the lines that are tested.
struct LinePart {
    Polygon polygon;
    const Piece* piece;
    Extent extent;  ///< along the lines
};

/// Tests the regions of one box.
class OpenTest {
public:
    explicit OpenTest(const OpenRequest& request)
        : request_(request), rounding_(request.surface.rounding()), outward_(request.pieces.size()) {}

    bool run(const Polyhedron& region, const Point3d& direction) {
        return opens_along_any(region, direction, max_divisions);
    }

private:
    /// Tests lines along the direction through the region, and along other directions. If none opens all of the region, tests its parts. The lines
    /// that failed are divided from the others; else the planes of pieces divide the region.
    bool opens_along_any(const Polyhedron& region, const Point3d& direction, int divisions) {
        if (is_outside(region)) return true;
        crossing_ = {};
        if (opens(region, direction) && (is_near_face(direction) || !is_crossed_by_both(region))) return true;
        const std::vector<CutPlane> conflict = std::move(crossing_.lines);
        if (opens_obliquely(region)) return true;
        if (divisions == 0 || tests_ > max_tests) return false;
        auto parts = divided(region, conflict);
        if (!parts) parts = divided(region, planes_of_pieces(direction));
        return parts && opens_along_any((*parts)[0], direction, divisions - 1) &&
               opens_along_any((*parts)[1], direction, divisions - 1);
    }

    /// Tests lines along directions that need not be near the normal of a face.
    bool opens_obliquely(const Polyhedron& region) {
        const std::vector<Point3d> normals = normals_around(region);
        const auto mean = mean_normal(region), along = mean ? way_along(normals, *mean) : std::nullopt;
        for (const auto& direction : {mean, common_way_out(normals), along}) {
            if (direction && opens(region, *direction)) return is_near_face(*direction) || !is_crossed_by_both(region);
        }
        return false;
    }

    bool is_near_face(const Point3d& direction) const {
        return std::any_of(request_.pieces.begin(), request_.pieces.end(),
                           [&](const Piece& piece) { return std::abs(vector::dot(piece.normal, direction)) > 0.9; });
    }

    /// Returns whether lines along the normal of one face enter and leave the overlap through a alone, and those along the normal of another face
    /// through b alone. Then the solids go through each other, as a square rod goes through a sheet of its own thickness, though lines from
    /// edge to edge leave through both.
    bool is_crossed_by_both(const Polyhedron& region) {
        std::array<bool, 2> crossed = {};
        std::vector<Point3d> tested;
        for (const Point3d& normal : normals_around(region)) {
            const auto is_same = [&](const Point3d& other) { return std::abs(vector::dot(other, normal)) > 1 - 1e-4; };
            if (std::any_of(tested.begin(), tested.end(), is_same)) continue;
            tested.push_back(normal);
            crossing_ = {};
            if (opens(region, normal)) return false;
            if (crossing_.side) crossed[*crossing_.side] = true;
            if (tests_ > max_tests || (crossed[0] && crossed[1])) return true;
        }
        return false;
    }

    /// Returns whether the region has no part of the overlap: no piece, and no point in both solids.
    bool is_outside(const Polyhedron& region) const {
        const std::vector<CutPlane>& planes = region.planes();
        const bool has_piece = std::any_of(request_.pieces.begin(), request_.pieces.end(), [&](const Piece& piece) {
            return !part_within(piece.polygon, planes, rounding_).empty();
        });
        return !has_piece && !request_.surface.in_both(region.middle());
    }

    /// Returns the parts of a region on the two sides of the first plane that crosses it; nothing if none does.
    std::optional<std::array<Polyhedron, 2>> divided(const Polyhedron& region, std::span<const CutPlane> planes) const {
        for (const CutPlane& plane : planes) {
            const auto [low, high] = region.along(plane.normal);
            if (low > plane.offset - 4 * rounding_ || high < plane.offset + 4 * rounding_) continue;
            std::array<Polyhedron, 2> sides = {region, region};
            sides[0].cut(plane, rounding_);
            sides[1].cut({vector::times(plane.normal, -1), -plane.offset}, rounding_);
            if (!sides[0].empty() && !sides[1].empty()) return sides;
        }
        return std::nullopt;
    }

    /// Returns the planes of all pieces. Those that are nearest to parallel to `direction` come first.
    std::vector<CutPlane> planes_of_pieces(const Point3d& direction) const {
        std::vector<CutPlane> planes;
        for (const Piece& piece : request_.pieces) {
            planes.push_back({piece.normal, vector::dot(piece.normal, piece.polygon.corners[0])});
        }
        std::stable_sort(planes.begin(), planes.end(), [&](const CutPlane& p, const CutPlane& q) {
            return std::abs(vector::dot(p.normal, direction)) < std::abs(vector::dot(q.normal, direction));
        });
        return planes;
    }

    /// Tests the lines along `direction` through the region.
    bool opens(const Polyhedron& region, const Point3d& direction) {
        if (++tests_ > max_tests) return false;
        const std::vector<CutPlane> sides = prism_over(region.corners(), direction);
        std::vector<LinePart> parts = parts_within(sides, direction);
        Extent extent = region.along(direction);
        if (!widen({region.middle(), parts, direction}, extent)) return false;
        std::erase_if(parts, [&](const LinePart& part) {
            return part.extent.low > extent.high + rounding_ || part.extent.high < extent.low - rounding_;
        });
        return have_two_solids(parts, direction);
    }

    std::vector<LinePart> parts_within(const std::vector<CutPlane>& sides, const Point3d& direction) const {
        std::vector<LinePart> parts;
        for (const Piece& piece : request_.pieces) {
            Polygon part = part_within(piece.polygon, sides, rounding_);
            if (part.empty()) continue;
            const Extent extent = extent_along(direction, part);
            parts.push_back({std::move(part), &piece, extent});
        }
        return parts;
    }

    /// Lines along one direction: a point on one of them, and the parts of pieces on them.
    struct Lines {
        Point3d middle;
        const std::vector<LinePart>& parts;
        const Point3d& direction;
    };

    /// Widens the extent until the lines are outside of the overlap at both of its ends. Returns false if it becomes wider than the tolerance.
    bool widen(const Lines& lines, Extent& extent) const {
        const auto high = end_of_overlap(lines, extent.high, 1);
        const auto low = end_of_overlap(lines, extent.low, -1);
        if (!high || !low) return false;
        extent = {*low, *high};
        return extent.high - extent.low <= request_.most;
    }

    /// Returns the first place from `from` on, upward (sense 1) or downward (-1), where no line is in the overlap; nothing if there is none in
    /// the domain.
    std::optional<double> end_of_overlap(const Lines& lines, double from, int sense) const {
        // Distances from `from` grow in the sense of the search.
        const auto nearest = [&](const LinePart& part) {
            return sense > 0 ? part.extent.low - from : from - part.extent.high;
        };
        const auto farthest = [&](const LinePart& part) {
            return sense > 0 ? part.extent.high - from : from - part.extent.low;
        };
        double at = 0;
        while (at <= request_.most) {
            double beyond = at;
            for (const LinePart& part : lines.parts) {
                if (nearest(part) <= at + rounding_ && farthest(part) > at + rounding_)
                    beyond = std::max(beyond, farthest(part));
            }
            if (beyond == at) {
                // No piece crosses the lines just beyond: one point decides for all of them.
                const double beside = from + sense * (at + 16 * rounding_) - vector::dot(lines.direction, lines.middle);
                if (!request_.surface.in_both(vector::plus(lines.middle, vector::times(lines.direction, beside)))) {
                    return from + sense * at;
                }
                beyond = std::numeric_limits<double>::infinity();
                for (const LinePart& part : lines.parts) {
                    if (nearest(part) > at + rounding_) beyond = std::min(beyond, nearest(part));
                }
            }
            at = beyond;
        }
        return std::nullopt;
    }

    /// Returns whether no lines enter and leave the overlap through one solid alone.
    bool have_two_solids(const std::vector<LinePart>& parts, const Point3d& direction) {
        for (const LinePart& above : parts) {
            const auto leaving = way_of(*above.piece, direction);
            if (!leaving) return false;
            if (*leaving <= 0) continue;
            for (const LinePart& below : parts) {
                if (below.piece->side != above.piece->side) continue;
                const auto entering = way_of(*below.piece, direction);
                if (!entering) return false;
                if (*entering < 0 && has_one_solid(direction, {above, below, parts})) return false;
            }
        }
        return true;
    }

    struct PartPair {
        const LinePart &above, &below;
        const std::vector<LinePart>& all;
    };
    /// Returns whether a piece of the other solid lies in the same place as `polygon`, a part of a piece, and faces the same way. Then lines cross
    /// the surfaces of both solids there.
    bool is_shared(const Polygon& polygon, const LinePart& part, const std::vector<LinePart>& all,
                   const Point3d& direction) {
        return std::any_of(all.begin(), all.end(), [&](const LinePart& other) {
            if (other.piece->side == part.piece->side) return false;
            if (std::abs(vector::dot(other.piece->normal, part.piece->normal)) < 1 - 1e-6) return false;
            if (way_of(*other.piece, direction) != way_of(*part.piece, direction)) return false;
            std::vector<CutPlane> planes = prism_over(other.polygon.corners, direction);
            const double offset = vector::dot(other.piece->normal, other.polygon.corners[0]);
            planes.push_back({other.piece->normal, offset});
            planes.push_back({vector::times(other.piece->normal, -1), -offset});
            return std::all_of(planes.begin(), planes.end(), [&](const CutPlane& plane) {
                return extent_along(plane.normal, polygon).high <= plane.offset + 2 * rounding_;
            });
        });
    }

    /// Returns whether some lines enter the overlap at one part and leave it at another part of the same solid, and through that solid alone.
    bool has_one_solid(const Point3d& direction, const PartPair& pair) {
        const Polygon common =
            part_within(pair.above.polygon, prism_over(pair.below.polygon.corners, direction), rounding_);
        if (common.empty()) return false;
        const Point3d up = vector::minus(middle_of(common), pair.below.polygon.corners[0]);
        // The line leaves the solid below the place where it enters.
        if (vector::dot(outward_normal(*pair.below.piece), up) >= -rounding_) return false;
        std::vector<CutPlane> sides = prism_over(common.corners, direction);
        if (sides.size() < 3) return false;  // no area
        const Polygon entrance = part_within(pair.below.polygon, sides, rounding_);
        if (is_shared(common, pair.above, pair.all, direction)) return false;
        if (!entrance.empty() && is_shared(entrance, pair.below, pair.all, direction)) return false;
        crossing_ = {std::move(sides), pair.above.piece->side};
        return true;
    }

    /// Returns the mean normal of the pieces around a region, those of b turned around: the way that a moves out of b, if all pieces agree.
    std::optional<Point3d> mean_normal(const Polyhedron& region) {
        Point3d sum = {};
        const Point3d middle = region.middle();
        for (const Piece& piece : request_.pieces) {
            const double distance =
                std::abs(vector::dot(piece.normal, vector::minus(middle, piece.polygon.corners[0])));
            if (distance > request_.most || !way_of(piece, piece.normal)) continue;
            sum = vector::plus(sum, vector::times(outward_normal(piece), piece.side == 0 ? piece.area : -piece.area));
        }
        const double length = vector::length(sum);
        return length > 0 ? direction_of(vector::times(sum, 1 / length)) : std::nullopt;
    }

    /// Returns the normals of the pieces that touch a region, those of b turned around; nothing if the solid of one is not known.
    std::vector<Point3d> normals_around(const Polyhedron& region) {
        std::vector<Point3d> normals;
        for (const Piece& piece : request_.pieces) {
            if (!touches(region, piece.polygon)) continue;
            if (!outward(piece)) return {};
            normals.push_back(vector::times(outward_normal(piece), piece.side == 0 ? 1 : -1));
        }
        return normals;
    }

    /// Returns the normal that agrees least with a direction. Requires: there is one.
    static const Point3d& least_along(const std::vector<Point3d>& normals, const Point3d& direction) {
        return *std::min_element(normals.begin(), normals.end(), [&](const Point3d& p, const Point3d& q) {
            return vector::dot(p, direction) < vector::dot(q, direction);
        });
    }

    /// Returns a direction that agrees with all normals; nothing if there is none. Of all directions, its smallest cosine with a normal is the
    /// largest: it leads from the origin to the nearest point of the normals' convex hull. Found step by step as by Gilbert 1966, "An iterative
    /// procedure for computing the minimum of a quadratic form on a convex set".
    static std::optional<Point3d> common_way_out(const std::vector<Point3d>& normals) {
        if (normals.empty()) return std::nullopt;
        Point3d nearest = normals[0];
        for (int i = 0; i < max_approaches; ++i) {
            const Point3d way = vector::minus(least_along(normals, nearest), nearest);
            const double part = -vector::dot(nearest, way) / vector::dot(way, way);
            if (!(part > 1e-3)) break;  // near enough
            nearest = vector::plus(nearest, vector::times(way, std::min(part, 1.0)));
        }
        const double length = vector::length(nearest);
        return length > 0.01 ? direction_of(vector::times(nearest, 1 / length)) : std::nullopt;
    }

    /// Returns the direction along the face that agrees least with `mean`, as near to `mean` as possible; nothing if all faces agree. At an acute
    /// edge, lines along one of its faces are the shortest that cross the other face alone.
    static std::optional<Point3d> way_along(const std::vector<Point3d>& normals, const Point3d& mean) {
        if (normals.empty()) return std::nullopt;
        const Point3d& least = least_along(normals, mean);
        const double against = vector::dot(least, mean);
        return against < 0 ? direction_of(vector::minus(mean, vector::times(least, against))) : std::nullopt;
    }

    /// Returns whether the polygon meets the region, or its surface.
    bool touches(const Polyhedron& region, Polygon polygon) const {
        for (const CutPlane& plane : region.planes()) {
            polygon = cut_below(std::move(polygon), {plane.normal, plane.offset + 4 * rounding_}, rounding_);
            if (polygon.empty()) return false;
        }
        return true;
    }

    /// Says which way the solid of a piece faces along a direction: 1 along it, -1 against it, 0 neither; nothing if the solid is on both
    /// sides of the piece, or on none.
    std::optional<int> way_of(const Piece& piece, const Point3d& direction) {
        const double cosine = vector::dot(piece.normal, direction);
        if (std::abs(cosine) <= facing) return 0;
        const std::optional<int> sense = outward(piece);
        if (!sense) return std::nullopt;
        return cosine > 0 ? *sense : -*sense;
    }
    Point3d outward_normal(const Piece& piece) { return vector::times(piece.normal, outward(piece).value_or(1)); }

    /// Returns 1 if the normal of the piece points out of its solid, -1 if it points inward. Tests points on both sides: the order of the
    /// corners alone says nothing for meshes that are inside out or mirrored.
    std::optional<int> outward(const Piece& piece) {
        auto& known = outward_[std::size_t(&piece - request_.pieces.data())];
        if (!known) {
            const Point3d middle = middle_of(piece.polygon), step = vector::times(piece.normal, 1024 * rounding_);
            const bool before = request_.surface.in_solid(piece.side, vector::minus(middle, step));
            const bool behind = request_.surface.in_solid(piece.side, vector::plus(middle, step));
            known = before == behind ? 0 : before ? 1 : -1;
        }
        return *known == 0 ? std::nullopt : known;
    }

    const OpenRequest& request_;
    double rounding_;
    std::vector<std::optional<int>> outward_;  // by piece: 1, -1, or 0 if the solid is on both sides or on none
    /// Lines that failed a test, because they enter and leave the overlap through one solid alone.
    struct Crossing {
        std::vector<CutPlane> lines;   // sides of their prism
        std::optional<unsigned> side;  // of the solid
    };
    Crossing crossing_;  // the last one
    int tests_ = 0;
};

}  // namespace

bool opens(const OpenRequest& request, const Box3d& box, std::span<const Plank> planks) {
    OpenTest test(request);
    const double rounding = request.surface.rounding();
    return std::all_of(planks.begin(), planks.end(), [&](const Plank& plank) {
        Polyhedron region({box}, rounding);
        const std::array<CutPlane, 2> planes = {
            {{plank.normal, plank.extent.high}, {vector::times(plank.normal, -1), -plank.extent.low}}};
        region.cut_to(planes, rounding);
        return region.empty() || test.run(region, plank.normal);
    });
}

bool is_pierced(const OpenRequest& request, const Box3d& box) {
    const auto& pieces = request.pieces;
    const auto of_one_solid = [&](const Piece& piece) { return piece.side == pieces.front().side; };
    if (pieces.empty() || !std::all_of(pieces.begin(), pieces.end(), of_one_solid)) return false;
    const std::vector<CutPlane> sides = planes_of(box);
    return std::any_of(pieces.begin(), pieces.end(), [&](const Piece& piece) {
        const Polygon part = part_within(piece.polygon, sides, request.surface.rounding());
        if (part.empty()) return false;
        const Point3d step = vector::times(piece.normal, 1024 * request.surface.rounding());
        return request.surface.in_both(vector::minus(middle_of(part), step)) ||
               request.surface.in_both(vector::plus(middle_of(part), step));
    });
}

}  // namespace octopair
