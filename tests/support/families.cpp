#include "support/families.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "samples/random.hpp"

namespace octopair::test {

namespace {

using samples::RandomStream;
using Point = std::array<double, 3>;
using Boxes3d = std::vector<Box3d>;

/// The number of objects and the random stream of a family.
struct Draw {
    std::uint64_t objects;
    RandomStream random;

    /// Returns the approximate distance between neighbours in the unit cube.
    double spacing() const { return 1 / std::cbrt(double(std::max<std::uint64_t>(1, objects))); }
    Point point() { return {random.uniform(), random.uniform(), random.uniform()}; }
    /// Returns 2^x with x uniform in [low, high).
    double power_of_two(double low, double high) { return std::exp2(random.uniform(low, high)); }
    bool chance(double part) { return random.uniform() < part; }
    /// Returns a random direction, not quite uniform.
    Point direction() {
        Point way{random.gaussian(), random.gaussian(), random.gaussian()};
        const double length = std::sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]) + 1e-9;
        for (double& x : way) x /= length;
        return way;
    }
};

Box3d around(const Point& centre, const Point& sides) {
    Box3d box;
    for (int axis = 0; axis < 3; ++axis) {
        box.min[axis] = centre[axis] - sides[axis] / 2;
        box.max[axis] = centre[axis] + sides[axis] / 2;
    }
    return box;
}

Box3d hull(const Box3d& a, const Box3d& b) {
    Box3d both;
    for (int axis = 0; axis < 3; ++axis) {
        both.min[axis] = std::min(a.min[axis], b.min[axis]);
        both.max[axis] = std::max(a.max[axis], b.max[axis]);
    }
    return both;
}

template <typename Next>
Boxes3d repeat(std::uint64_t count, Next&& next) {
    Boxes3d boxes;
    for (std::uint64_t i = 0; i < count; ++i) boxes.push_back(next());
    return boxes;
}

/// Sizes over a factor of 4 to 64, times a random factor of 0.3 to 1.3, with a different typical size on each axis.
Boxes3d anisotropic(Draw& draw) {
    Point typical;
    for (double& side : typical) side = draw.spacing() * draw.power_of_two(-4, 1);
    const double tail = draw.random.uniform(2, 6);
    return repeat(draw.objects, [&] {
        Point sides;
        for (int axis = 0; axis < 3; ++axis) {
            sides[axis] = std::min(0.5, typical[axis] * draw.power_of_two(0, tail) * (0.3 + draw.random.uniform()));
        }
        return around(draw.point(), sides);
    });
}

/// Sides by a power law, equal on all axes or independent on each axis.
Boxes3d long_tail(Draw& draw) {
    const double exponent = draw.random.uniform(0.25, 0.75), least = draw.spacing() * draw.power_of_two(-3, -1);
    const bool cubes = draw.chance(0.5);
    const auto side = [&] { return std::min(0.4, least * std::pow(1 - draw.random.uniform(), -exponent)); };
    return repeat(draw.objects, [&] {
        const double one = side();
        const Point sides = cubes ? Point{one, one, one} : Point{side(), side(), side()};
        return around(draw.point(), sides);
    });
}

/// Centres by a power law on each axis: dense at a corner, thin elsewhere.
Boxes3d power_law(Draw& draw) {
    Point exponents;
    for (double& exponent : exponents) exponent = draw.random.uniform(1, 5);
    const double size = draw.spacing() * draw.power_of_two(-2, 0);
    return repeat(draw.objects, [&] {
        Point centre = draw.point(), sides;
        for (int axis = 0; axis < 3; ++axis) {
            sides[axis] = size * std::pow(centre[axis], (exponents[axis] - 1) / 2) * draw.random.uniform(0.2, 1);
            centre[axis] = std::pow(centre[axis], exponents[axis]);
        }
        return around(centre, sides);
    });
}

/// Patches of a sphere's surface.
Boxes3d surface(Draw& draw) {
    const double patch = draw.power_of_two(0, 2) / std::sqrt(double(draw.objects) + 1);
    const double thickness = patch * draw.power_of_two(-8, 0);
    return repeat(draw.objects, [&] {
        Point centre = draw.direction(), sides;
        for (int axis = 0; axis < 3; ++axis) {
            sides[axis] = thickness + patch * (1 - std::abs(centre[axis])) * draw.random.uniform(0.5, 1);
            centre[axis] = 0.5 + centre[axis] / 2;
        }
        return around(centre, sides);
    });
}

/// A folded sheet with a given number of cells on each side.
class Cloth {
public:
    Cloth(std::uint64_t side, Draw& draw) : side_(side) {
        for (double& wave : waves_) wave = draw.random.uniform(1, 9);
        for (double& depth : depths_) depth = draw.random.uniform(0.01, 0.3);
        thickness_ = draw.power_of_two(-3, 1) / double(side + 1);
    }
    Box3d vertex(std::uint64_t u, std::uint64_t v) const {
        return around(at(u, v), {thickness_, thickness_, thickness_});
    }
    /// Returns the box of the upper or the lower triangle of a cell.
    Box3d face(std::uint64_t u, std::uint64_t v, bool upper) const {
        const auto bare = [&](std::uint64_t i, std::uint64_t k) { return around(at(i, k), {0, 0, 0}); };
        const Box3d diagonal = hull(bare(u + 1, v), bare(u, v + 1));
        return hull(diagonal, upper ? bare(u + 1, v + 1) : bare(u, v));
    }
    std::uint64_t side() const { return side_; }

private:
    Point at(std::uint64_t u, std::uint64_t v) const {
        const double x = double(u) / double(side_ + 1), y = double(v) / double(side_ + 1);
        const double fold = depths_[0] * std::sin(waves_[0] * x * 6) + depths_[1] * std::sin(waves_[1] * (x + y) * 6);
        return {x + depths_[2] * std::sin(waves_[2] * y * 6) / 4, y, 0.5 + fold};
    }

    std::uint64_t side_;
    std::array<double, 3> waves_, depths_;
    double thickness_;
};

Boxes3d cloth_faces(const Cloth& cloth) {
    Boxes3d boxes;
    for (std::uint64_t u = 0; u < cloth.side(); ++u) {
        for (std::uint64_t v = 0; v < cloth.side(); ++v) {
            boxes.push_back(cloth.face(u, v, false));
            boxes.push_back(cloth.face(u, v, true));
        }
    }
    return boxes;
}

Boxes3d cloth_vertices(const Cloth& cloth) {
    Boxes3d boxes;
    for (std::uint64_t u = 0; u <= cloth.side(); ++u) {
        for (std::uint64_t v = 0; v <= cloth.side(); ++v) boxes.push_back(cloth.vertex(u, v));
    }
    return boxes;
}

Boxes3d cloth(Draw& draw) { return cloth_faces(Cloth(1 + std::uint64_t(std::sqrt(double(draw.objects) / 2)), draw)); }

/// Boxes around the start and end of an object's step. Some steps are long.
Boxes3d swept(Draw& draw) {
    const double size = draw.spacing() * draw.power_of_two(-3, -1), exponent = draw.random.uniform(0.2, 0.8);
    return repeat(draw.objects, [&] {
        const Point from = draw.point(), way = draw.direction();
        const double length = std::min(0.5, size * std::pow(1 - draw.random.uniform(), -exponent));
        Point to;
        for (int axis = 0; axis < 3; ++axis) to[axis] = from[axis] + way[axis] * length;
        return hull(around(from, {size, size, size}), around(to, {size, size, size}));
    });
}

/// Integer coordinates, so that the faces of boxes and octants coincide exactly. The world is not the unit cube.
Boxes3d lattice(Draw& draw) {
    const double cells = std::max(1.0, std::floor(draw.random.uniform(0.7, 2) / draw.spacing()));
    const std::uint64_t longest = 2 + draw.random.below(3);
    return repeat(draw.objects, [&] {
        Box3d box;
        for (int axis = 0; axis < 3; ++axis) {
            box.min[axis] = std::floor(draw.random.uniform() * cells);
            const bool long_one = draw.chance(0.02);
            box.max[axis] = box.min[axis] + double(draw.random.below(long_one ? 16 : longest));
        }
        return box;
    });
}

/// Clusters within clusters, each a small part of the cluster around it.
Boxes3d nested_clusters(Draw& draw) {
    const unsigned levels = 1 + unsigned(draw.random.below(4));
    const double part = draw.power_of_two(-9, -2);
    std::array<std::vector<Point>, 4> centres;
    for (auto& of_level : centres) {
        for (std::uint64_t i = 0, count = 2 + draw.random.below(4); i < count; ++i) of_level.push_back(draw.point());
    }
    const double size = draw.spacing() * draw.power_of_two(-1, 1.5);
    return repeat(draw.objects, [&] {
        const unsigned depth = draw.chance(0.8) ? levels : unsigned(draw.random.below(levels + 1));
        Point at{0, 0, 0};
        double scale = 1;
        for (unsigned level = 0; level < depth; ++level, scale *= part) {
            const Point& centre = centres[level][std::size_t(draw.random.below(centres[level].size()))];
            for (int axis = 0; axis < 3; ++axis) at[axis] += scale * centre[axis];
        }
        const Point offset = draw.point();
        const double side = scale * size * draw.random.uniform(0.2, 1);
        for (int axis = 0; axis < 3; ++axis) at[axis] += scale * offset[axis];
        return around(at, {side, side, side});
    });
}

/// Returns a number of world-sized objects, at most 1 + 4 * sqrt(objects), so that the average object has few pairs.
std::uint64_t world_sized(Draw& draw) {
    const double most = 1 + 4 * std::sqrt(double(draw.objects));
    return std::min(draw.objects, std::uint64_t(draw.random.uniform(0, most)));
}

Box3d dust(Draw& draw, double size) {
    const double side = size * draw.random.uniform(0.1, 1);
    return around(draw.point(), {side, side, side});
}

/// Long thin boxes along one axis or several.
Boxes3d rods(Draw& draw) {
    const double thickness = draw.spacing() * draw.power_of_two(-8, -3),
                 size = draw.spacing() * draw.power_of_two(-3, 0);
    const std::uint64_t axes = 1 + draw.random.below(3), count = world_sized(draw);
    Boxes3d boxes = repeat(count, [&] {
        Point sides{thickness, thickness, thickness};
        sides[std::size_t(draw.random.below(axes))] = draw.random.uniform(0.1, 1);
        return around(draw.point(), sides);
    });
    while (boxes.size() < draw.objects) boxes.push_back(dust(draw, size));
    return boxes;
}

/// Wide flat boxes, parallel or not, with or without small boxes between them.
Boxes3d sheets(Draw& draw) {
    const double thickness = draw.spacing() * draw.power_of_two(-12, -4),
                 size = draw.spacing() * draw.power_of_two(-3, 0);
    const std::uint64_t axes = draw.chance(0.7) ? 1 : 3;
    const bool all = axes == 1 && draw.chance(0.3);
    const std::uint64_t count = all ? draw.objects : std::min<std::uint64_t>(world_sized(draw), axes == 1 ? ~0ull : 60);
    const double thin = all ? draw.spacing() * draw.spacing() * draw.spacing() : thickness;
    Boxes3d boxes = repeat(count, [&] {
        Point sides{draw.random.uniform(0.3, 1), draw.random.uniform(0.3, 1), draw.random.uniform(0.3, 1)};
        sides[std::size_t(draw.random.below(axes))] = thin;
        return around(draw.point(), sides);
    });
    while (boxes.size() < draw.objects) boxes.push_back(dust(draw, size));
    return boxes;
}

/// A few boxes of every size up to the size of the world. All other boxes are small.
Boxes3d six_decades(Draw& draw) {
    return repeat(draw.objects, [&] {
        const double share = draw.random.uniform();
        const double side = std::min(0.9, draw.spacing() * std::pow(share + 1e-3, -0.4) * draw.power_of_two(-12, -1));
        return around(draw.point(), {side, side, side});
    });
}

/// Objects in layers of a flat world.
Boxes3d flat(Draw& draw) {
    const double layers = double(draw.random.below(3)),
                 size = draw.power_of_two(-2, 0.5) / std::sqrt(double(draw.objects) + 1);
    const double height = draw.chance(0.5) ? 0 : size;
    return repeat(draw.objects, [&] {
        Point centre = draw.point();
        centre[2] = std::floor(centre[2] * (layers + 1));
        const double side = size * draw.random.uniform(0.2, 1);
        return around(centre, {side, side, height});
    });
}

/// Piles of 1 to 30 equal boxes.
Boxes3d piles(Draw& draw) {
    const double size = draw.spacing() * draw.power_of_two(-1, 1);
    Boxes3d boxes;
    while (boxes.size() < draw.objects) {
        const Box3d first = dust(draw, size);
        for (std::uint64_t i = 1 + draw.random.below(30); i > 0 && boxes.size() < draw.objects; --i)
            boxes.push_back(first);
    }
    return boxes;
}

struct Family {
    const char* name;
    Boxes3d (*make)(Draw&);
};

constexpr std::array families = {
    Family{"anisotropic", anisotropic},
    Family{"long_tail", long_tail},
    Family{"power_law", power_law},
    Family{"surface", surface},
    Family{"cloth", cloth},
    Family{"swept", swept},
    Family{"lattice", lattice},
    Family{"nested", nested_clusters},
    Family{"rods", rods},
    Family{"sheets", sheets},
    Family{"six_decades", six_decades},
    Family{"flat", flat},
    Family{"piles", piles},
};

const Family& family_of(const std::string& name) {
    for (const Family& family : families) {
        if (name == family.name) return family;
    }
    throw std::invalid_argument("no family is called " + name);
}

/// Moves, scales and reorients all boxes of a scene.
struct Placement {
    std::array<int, 3> axes = {0, 1, 2};
    std::array<bool, 3> mirrored = {};
    double scale = 1;
    Point offset = {0, 0, 0};

    explicit Placement(Draw& draw) {
        for (std::size_t i = 0; i < 2; ++i) std::swap(axes[i], axes[i + std::size_t(draw.random.below(3 - i))]);
        for (bool& mirror : mirrored) mirror = draw.chance(0.5);
        if (draw.chance(0.3)) scale = std::ldexp(1.0, int(draw.random.below(41)) - 20);
        // Far from the origin, so that float32 has few values left.
        if (draw.chance(0.25)) {
            for (double& x : offset) x = scale * std::ldexp(draw.random.uniform(-1, 1), int(draw.random.below(12)));
        }
    }
    void place(Boxes3d& boxes) const {
        for (Box3d& box : boxes) {
            const Box3d old = box;
            for (int to = 0; to < 3; ++to) {
                const int from = axes[std::size_t(to)];
                const double low = mirrored[std::size_t(to)] ? -old.max[from] : old.min[from];
                const double high = mirrored[std::size_t(to)] ? -old.min[from] : old.max[from];
                box.min[to] = low * scale + offset[std::size_t(to)];
                box.max[to] = high * scale + offset[std::size_t(to)];
            }
        }
    }
};

/// Returns the boxes in float32 or unchanged, in a random order or in the order of their creation.
OwnedObjects owned(Boxes3d boxes, Draw& draw) {
    if (draw.chance(0.7)) {
        for (std::size_t i = boxes.size(); i > 1; --i)
            std::swap(boxes[i - 1], boxes[std::size_t(draw.random.below(i))]);
    }
    OwnedObjects objects;
    if (draw.chance(0.4)) {
        objects.boxes = std::move(boxes);
        return objects;
    }
    std::vector<Box3f> narrow;
    for (const Box3d& box : boxes) {
        Box3f& one = narrow.emplace_back();
        for (int axis = 0; axis < 3; ++axis) {
            one.min[axis] = float(box.min[axis]);
            one.max[axis] = float(box.max[axis]);
        }
    }
    objects.boxes = std::move(narrow);
    return objects;
}

void add_clearance(Case& a_case, double spacing, Draw& draw) {
    const auto clearance = [&] {
        return draw.chance(0.5) ? spacing * draw.power_of_two(-6, -2)
                                : std::ldexp(1.0, int(std::floor(std::log2(spacing))) - 3);
    };
    if (draw.chance(0.25)) a_case.margin = clearance();
    for (OwnedObjects* const set : {&a_case.first, a_case.second ? &*a_case.second : nullptr}) {
        if (set == nullptr || !draw.chance(0.15)) continue;
        for (std::uint64_t i = 0; i < set->view().size(); ++i) {
            set->padding.push_back(draw.chance(0.5) ? clearance() / 4 : 0);
        }
    }
}

}  // namespace

std::vector<std::string> family_names() {
    std::vector<std::string> names;
    for (const Family& family : families) names.emplace_back(family.name);
    return names;
}

Case make_family_case(const std::string& name, std::uint64_t objects, std::uint64_t seed) {
    Draw draw{objects, RandomStream(seed, 0)};
    const Family& family = family_of(name);
    const Placement placement(draw);
    Boxes3d first, second;
    const double kind = draw.random.uniform();
    if (name == "cloth" && kind < 0.5) {
        // Vertices against faces, as in cloth simulations.
        const Cloth sheet(1 + std::uint64_t(std::sqrt(double(objects) / 3)), draw);
        first = cloth_vertices(sheet);
        second = cloth_faces(sheet);
    } else if (kind < 0.3) {
        // Two sets of different size and extent.
        const Family& other = families[std::size_t(draw.random.below(families.size()))];
        Draw of_first{1 + draw.random.below(objects), draw.random};
        Draw of_second{objects - of_first.objects + 1, RandomStream(seed, 1)};
        first = family.make(of_first);
        second = other.make(of_second);
        if (draw.chance(0.5)) Placement(of_second).place(second);
    } else {
        first = family.make(draw);
    }
    Case result;
    placement.place(first);
    placement.place(second);
    result.first = owned(std::move(first), draw);
    if (!second.empty()) result.second = owned(std::move(second), draw);
    add_clearance(result, draw.spacing() * placement.scale, draw);
    result.limit = draw.random.below(1 + 3 * objects);
    result.buffer_bytes = draw.chance(0.5) ? 0 : std::uint64_t(1) << draw.random.below(20);
    for (unsigned& threads : result.threads) threads = 1 + unsigned(draw.random.below(3));
    return result;
}

std::vector<Box3f> long_tailed_boxes(std::uint64_t objects, std::uint64_t seed) {
    constexpr std::array typical = {.0025, .0115, .041};
    std::vector<Box3f> boxes(objects);
    for (std::uint64_t i = 0; i < objects; ++i) {
        RandomStream random(seed, i);
        Point centre;
        for (double& x : centre) x = random.uniform();
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double exponent = 4 * random.uniform(),
                         side = typical[axis] * std::exp2(exponent) * (0.3 + random.uniform());
            boxes[i].min[axis] = float(centre[axis] - side / 2);
            boxes[i].max[axis] = float(centre[axis] + side / 2);
        }
    }
    return boxes;
}

}  // namespace octopair::test
