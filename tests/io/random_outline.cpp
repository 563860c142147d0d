#include "io/random_outline.hpp"

#include <algorithm>
#include <map>
#include <sstream>
#include <utility>

namespace octopair::test {
namespace {

using Random = std::mt19937_64;
using Plane = std::array<std::int64_t, 2>;
using Walk = std::vector<Plane>;

std::int64_t some(std::int64_t low, std::int64_t high, Random& random) {
    return std::uniform_int_distribution<std::int64_t>(low, high)(random);
}

Wide turn(const Plane& a, const Plane& b, const Plane& c) {
    return Wide(b[0] - a[0]) * (c[1] - a[1]) - Wide(b[1] - a[1]) * (c[0] - a[0]);
}

/// A grid of squares, each cut into two triangles. Its places may be moved a little.
class Grid {
public:
    explicit Grid(Random& random) : squares_(some(2, 7, random)) {
        const std::int64_t wobble = some(0, 1, random) * 3;
        for (std::int64_t y = 0; y <= squares_; ++y) {
            for (std::int64_t x = 0; x <= squares_; ++x)
                places_.push_back({16 * x + some(-wobble, wobble, random), 16 * y + some(-wobble, wobble, random)});
        }
        for (int y = 0; y < squares_; ++y) {
            for (int x = 0; x < squares_; ++x) {
                const int a = number(x, y), b = number(x + 1, y), c = number(x + 1, y + 1), d = number(x, y + 1);
                if (some(0, 1, random) == 0) {
                    add({a, b, c});
                    add({a, c, d});
                } else {
                    add({a, b, d});
                    add({b, c, d});
                }
            }
        }
    }

    /// Returns the outline of a connected set of triangles, as places' numbers. It grows by one triangle after the other across an edge,
    /// so it is that of a disk that touches itself.
    std::vector<int> grow(Random& random) const {
        std::vector<bool> used(triangles_.size());
        const auto first = std::size_t(some(0, std::int64_t(triangles_.size()) - 1, random));
        used[first] = true;
        std::vector<int> outline(triangles_[first].begin(), triangles_[first].end());
        for (std::int64_t tries = some(0, 150, random); tries > 0; --tries) {
            const auto at = std::size_t(some(0, std::int64_t(outline.size()) - 1, random));
            const auto beyond = beyond_.find({outline[(at + 1) % outline.size()], outline[at]});
            if (beyond == beyond_.end() || used[beyond->second.triangle]) continue;
            used[beyond->second.triangle] = true;
            outline.insert(outline.begin() + std::ptrdiff_t(at) + 1, beyond->second.corner);
        }
        return outline;
    }

    /// Adds a way to a neighbour and back.
    void add_spike(std::vector<int>& outline, Random& random) const {
        const auto at = std::size_t(some(0, std::int64_t(outline.size()) - 1, random));
        std::vector<int> tips;
        for (const auto& [edge, beyond] : beyond_) {
            if (edge.first == outline[at]) tips.push_back(edge.second);
        }
        const int tip = tips[std::size_t(some(0, std::int64_t(tips.size()) - 1, random))];
        const int way[2] = {tip, outline[at]};
        outline.insert(outline.begin() + std::ptrdiff_t(at) + 1, way, way + 2);
    }

    const Plane& place(int number) const { return places_[std::size_t(number)]; }

private:
    int number(int x, int y) const { return y * int(squares_ + 1) + x; }

    void add(const std::array<int, 3>& corners) {
        for (std::size_t k = 0; k < 3; ++k)
            beyond_[{corners[k], corners[(k + 1) % 3]}] = {triangles_.size(), corners[(k + 2) % 3]};
        triangles_.push_back(corners);
    }

    /// The triangle left of an edge, and its other corner.
    struct Beyond {
        std::size_t triangle;
        int corner;
    };

    std::int64_t squares_;
    std::vector<Plane> places_;
    std::vector<std::array<int, 3>> triangles_;
    std::map<std::pair<int, int>, Beyond> beyond_;
};

/// Removes some corners within straight ways.
std::vector<int> remove_corners(const std::vector<int>& outline, const Grid& grid, Random& random) {
    const std::int64_t removed = some(0, 4, random);
    std::vector<int> left = {outline[0]};
    for (std::size_t i = 1; i < outline.size(); ++i) {
        const Plane &before = grid.place(left.back()), &at = grid.place(outline[i]),
                    &after = grid.place(outline[(i + 1) % outline.size()]);
        const bool onward = (at[0] - before[0]) * (after[0] - at[0]) + (at[1] - before[1]) * (after[1] - at[1]) > 0;
        if (turn(before, at, after) == 0 && onward && some(0, 3, random) < removed) continue;
        left.push_back(outline[i]);
    }
    return left;
}

/// Returns the outline of a disk, with spikes and with corners that are repeated. No two edges cross.
Walk touching_walk(Random& random) {
    const Grid grid(random);
    std::vector<int> outline = remove_corners(grid.grow(random), grid, random);
    for (std::int64_t spikes = some(-3, 3, random); spikes > 0; --spikes) grid.add_spike(outline, random);
    const bool repeats = some(0, 1, random) == 0;
    Walk walk;
    for (const int number : outline) {
        do walk.push_back(grid.place(number));
        while (repeats && some(0, 9, random) == 0);
    }
    return walk;
}

/// Returns a star-shaped outline around the origin.
Walk star_walk(Random& random) {
    Walk walk = {{1000, 1}, {-1, 1000}, {-1000, -1}, {1, -1000}};
    for (std::int64_t corners = some(0, 30, random); corners > 0; --corners) {
        const Plane place = {some(-1000, 1000, random), some(-1000, 1000, random)};
        if (place != Plane{0, 0}) walk.push_back(place);
    }
    const auto half = [](const Plane& place) { return place[1] < 0 || (place[1] == 0 && place[0] < 0); };
    const auto less = [&](const Plane& a, const Plane& b) {
        return half(a) != half(b) ? half(a) < half(b) : turn({0, 0}, a, b) > 0;
    };
    std::sort(walk.begin(), walk.end(), less);
    const auto same_way = [&](const Plane& a, const Plane& b) { return !less(a, b) && !less(b, a); };
    walk.erase(std::unique(walk.begin(), walk.end(), same_way), walk.end());
    return walk;
}

/// Returns the walk in a random plane of space.
WholeOutline put_into_space(const Walk& walk, Random& random) {
    const std::int64_t size = std::int64_t(1) << some(1, 33, random);
    for (;;) {
        std::array<WholePlace, 3> frame;
        for (WholePlace& way : frame) {
            for (std::int64_t& at : way) at = some(0, 2, random) == 0 ? 0 : some(-size, size, random);
        }
        WholeOutline outline;
        for (const Plane& at : walk) {
            WholePlace& place = outline.emplace_back(frame[2]);
            for (std::size_t k = 0; k < 3; ++k) place[k] += at[0] * frame[0][k] + at[1] * frame[1][k];
        }
        const auto area = whole_area_of(outline);
        if (area[main_axis(area)] != 0) return outline;
    }
}

}  // namespace

std::vector<Point3d> places_of(const WholeOutline& outline) {
    std::vector<Point3d> places;
    for (const WholePlace& place : outline)
        places.push_back({double(place[0]) * 0x1p-20, double(place[1]) * 0x1p-20, double(place[2]) * 0x1p-20});
    return places;
}

std::string text(const WholeOutline& outline) {
    std::ostringstream words;
    for (const WholePlace& place : outline) words << "{" << place[0] << ", " << place[1] << ", " << place[2] << "}, ";
    return words.str();
}

WholeOutline random_outline(std::mt19937_64& random) {
    Walk walk = some(0, 7, random) == 0 ? star_walk(random) : touching_walk(random);
    std::rotate(walk.begin(), walk.begin() + some(0, std::int64_t(walk.size()) - 1, random), walk.end());
    if (some(0, 1, random) == 0) std::reverse(walk.begin(), walk.end());
    return put_into_space(walk, random);
}

WholeOutline random_walk(unsigned most, std::mt19937_64& random) {
    WholeOutline outline;
    for (std::int64_t corners = some(4, most, random); corners > 0; --corners)
        outline.push_back({some(0, 4, random), some(0, 4, random), 0});
    return outline;
}

std::array<Wide, 3> whole_area_of(const WholeOutline& outline) {
    std::array<Wide, 3> area = {0, 0, 0};
    for (std::size_t i = 1; i + 1 < outline.size(); ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
            area[axis] += turn({outline[0][u], outline[0][v]}, {outline[i][u], outline[i][v]},
                               {outline[i + 1][u], outline[i + 1][v]});
        }
    }
    return area;
}

unsigned main_axis(const std::array<Wide, 3>& area) {
    const auto size = [&](unsigned axis) { return area[axis] < 0 ? -area[axis] : area[axis]; };
    unsigned largest = 0;
    for (unsigned axis = 1; axis < 3; ++axis) {
        if (size(axis) > size(largest)) largest = axis;
    }
    return largest;
}

int side_of(const std::array<WholePlace, 3>& places, unsigned axis) {
    const Wide area = whole_area_of({places[0], places[1], places[2]})[axis];
    return int(area > 0) - int(area < 0);
}

int winding_of(const WholeOutline& outline, const WholePlace& place, unsigned axis, bool& on_outline) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    int winding = 0;
    on_outline = false;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const WholePlace &from = outline[i], &to = outline[(i + 1) % outline.size()];
        const int side = side_of({from, to, place}, axis);
        const auto within = [&](std::size_t k) {
            return std::min(from[k], to[k]) <= place[k] && place[k] <= std::max(from[k], to[k]);
        };
        on_outline |= side == 0 && within(u) && within(v);
        if (from[v] <= place[v] && to[v] > place[v] && side > 0) ++winding;
        if (from[v] > place[v] && to[v] <= place[v] && side < 0) --winding;
    }
    return winding;
}

bool has_crossing(const WholeOutline& outline) {
    for (std::size_t i = 0; i < outline.size(); ++i) {
        for (std::size_t k = 0; k < i; ++k) {
            const WholePlace &a = outline[i], &b = outline[(i + 1) % outline.size()], &c = outline[k],
                             &d = outline[(k + 1) % outline.size()];
            if (side_of({a, b, c}, 2) * side_of({a, b, d}, 2) < 0 && side_of({c, d, a}, 2) * side_of({c, d, b}, 2) < 0)
                return true;
        }
    }
    return false;
}

bool overlaps(const WholeOutline& outline) {
    // Places beside each edge, in units of 2^-30. Edges are divided in thirds or quarters.
    constexpr std::int64_t unit = std::int64_t(1) << 30;
    WholeOutline fine = outline;
    for (WholePlace& place : fine) {
        for (std::int64_t& at : place) at *= unit;
    }
    int least = 0, greatest = 0;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const WholePlace &from = outline[i], &to = outline[(i + 1) % outline.size()];
        for (const double part : {0.137, 0.391, 0.613, 0.877}) {
            for (const std::int64_t beside : {-10000, 10000}) {
                WholePlace place = fine[i];
                place[0] += std::int64_t(part * double(unit)) * (to[0] - from[0]) + beside * (to[1] - from[1]);
                place[1] += std::int64_t(part * double(unit)) * (to[1] - from[1]) - beside * (to[0] - from[0]);
                bool on_outline = false;
                const int winding = winding_of(fine, place, 2, on_outline);
                least = std::min(least, winding);
                greatest = std::max(greatest, winding);
            }
        }
    }
    return greatest - least > 1;
}

}  // namespace octopair::test
