#include "samples/kinds.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "samples/random.hpp"

namespace octopair::samples {

namespace {

using Point = std::array<double, 3>;

Box3f box_of(const Point& low, const Point& extent) {
    Box3f box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        box.min[axis] = float(low[axis]);
        box.max[axis] = float(low[axis] + extent[axis]);
    }
    return box;
}

Point uniform_point(RandomStream& random) {
    Point point;
    for (double& x : point) x = random.uniform();
    return point;
}

/// Returns the cube root, by Newton's method in a fixed number of steps: std::cbrt may differ between libraries.
double cube_root(double x) {
    double root = 1;
    while (root * root * root < x) root *= 2;
    while (root * root * root > x * 8) root /= 2;
    for (int i = 0; i < 40; ++i) root = (2 * root + x / (root * root)) / 3;
    return root;
}

double count(const Population& population) { return double(std::max<std::uint64_t>(population.objects, 1)); }

Placer cubes(const Population& population, double pairs_per_object) {
    const double side = cube_side(population.objects, pairs_per_object);
    return [=](std::uint64_t i) {
        RandomStream random(population.seed, i);
        return box_of(uniform_point(random), {side, side, side});
    };
}

Placer uniform(const Population& population) { return cubes(population, 0.5); }
Placer dense(const Population& population) { return cubes(population, 5); }

/// Cubes of side smallest * 2^k * (1 + f), with k in 0..9 and f in [0, 1), both uniform: sizes span three decades.
Placer mixed(const Population& population) {
    constexpr int octaves = 10;
    constexpr double pairs_per_object = 2.4;
    double first = 0, second = 0, third = 0;  // moments of the side, in units of the smallest
    for (int k = 0; k < octaves; ++k) {
        const double scale = double(1 << k);
        first += scale * (3.0 / 2) / octaves;
        second += scale * scale * (7.0 / 3) / octaves;
        third += scale * scale * scale * (15.0 / 4) / octaves;
    }
    const double mean_cube_of_sum = 2 * third + 6 * second * first;
    const double smallest = cube_root(2 * pairs_per_object / (count(population) * mean_cube_of_sum));
    return [=](std::uint64_t i) {
        RandomStream random(population.seed, i);
        const double octave = double(1u << random.below(octaves));
        const double side = smallest * octave * random.uniform(1, 2);
        return box_of(uniform_point(random), {side, side, side});
    };
}

std::vector<Point> cluster_centres(std::uint64_t seed, std::size_t clusters) {
    std::vector<Point> centres(clusters);
    for (std::size_t c = 0; c < clusters; ++c) {
        RandomStream random(~seed, c);
        for (double& x : centres[c]) x = random.uniform(0.1, 0.9);
    }
    return centres;
}

Placer clustered(const Population& population) {
    constexpr double deviation = 0.03;
    const double side = cube_side(population.objects, 0.09);
    return [=, centres = cluster_centres(population.seed, 20)](std::uint64_t i) {
        RandomStream random(population.seed, i);
        Point low;
        if (random.below(5) == 0) {
            low = uniform_point(random);
        } else {
            const Point& centre = centres[random.below(centres.size())];
            for (std::size_t axis = 0; axis < 3; ++axis) low[axis] = centre[axis] + deviation * random.gaussian();
        }
        return box_of(low, {side, side, side});
    };
}

/// 20 clusters of uniformly distributed cubes; each cluster is 1e-5 of the world wide.
Placer micro20(const Population& population) {
    constexpr std::uint64_t clusters = 20;
    constexpr double width = 1e-5;
    const double side = width * cube_side(population.objects / clusters, 0.5);
    return [=, centres = cluster_centres(population.seed, clusters)](std::uint64_t i) {
        RandomStream random(population.seed, i);
        const Point& centre = centres[random.below(clusters)];
        Point low = uniform_point(random);
        for (std::size_t axis = 0; axis < 3; ++axis) low[axis] = centre[axis] + width * low[axis];
        return box_of(low, {side, side, side});
    };
}

/// Cubes in a flat world: its height is four sides of a cube.
Placer flat(const Population& population) {
    constexpr double height_in_sides = 4;
    constexpr double pairs_per_object = 0.75;
    constexpr double chance_in_z = 2 / height_in_sides - 1 / (height_in_sides * height_in_sides);
    const double side = std::sqrt(2 * pairs_per_object / (4 * chance_in_z * count(population)));
    return [=](std::uint64_t i) {
        RandomStream random(population.seed, i);
        Point low = uniform_point(random);
        low[2] *= height_in_sides * side;
        return box_of(low, {side, side, side});
    };
}

/// Returns a box of about the world's size: each face is moved inward by at most 1%.
Box3f world_size_box(RandomStream& random) {
    Box3f box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        box.min[axis] = float(random.uniform(0, 0.01));
        box.max[axis] = float(random.uniform(0.99, 1));
    }
    return box;
}

Placer world10(const Population& population) {
    const std::uint64_t stride = std::max<std::uint64_t>(population.objects / 10, 1);
    return [=, dust = uniform(population)](std::uint64_t i) {
        if (i % stride != 0 || i / stride >= 10) return dust(i);
        RandomStream random(population.seed, i);
        return world_size_box(random);
    };
}

template <std::size_t axis>
Placer same_interval(const Population& population) {
    const double side = std::sqrt(1 / (4 * count(population)));
    return [=](std::uint64_t i) {
        RandomStream random(population.seed, i);
        Box3f box = box_of(uniform_point(random), {side, side, side});
        box.min[axis] = 0.25f;
        box.max[axis] = 0.75f;
        return box;
    };
}

Placer coincident(const Population& population) {
    RandomStream random(population.seed, 0);
    return [box = box_of(uniform_point(random), {0.5, 0.5, 0.5})](std::uint64_t) { return box; };
}

/// Returns a stride of about the golden section of `slots` and coprime to it: i * stride mod slots takes each slot once.
std::uint64_t slot_stride(std::uint64_t slots) {
    std::uint64_t stride = slots * 618 / 1000 | 1;
    while (std::gcd(stride, slots) != 1) stride += 2;
    return stride;
}

/// Plates, each in its own slot along the axis. One in 1,000 is thick enough to reach the next plate.
template <std::size_t axis>
Placer plates(const Population& population) {
    const std::uint64_t slots = std::max<std::uint64_t>(population.objects, 1);
    const std::uint64_t stride = slot_stride(slots);
    return [=](std::uint64_t i) {
        RandomStream random(population.seed, i);
        Box3f box = world_size_box(random);
        const double slot = double(i * stride % slots);
        const double low = slot + random.uniform(0, 0.5);
        const double thickness = random.below(1000) == 0 ? 1.5 : 0.25;
        box.min[axis] = float(low / double(slots));
        box.max[axis] = float((low + thickness) / double(slots));
        return box;
    };
}

/// Every 20th object is a sheet; the other objects are small cubes. Their sides give 0.4 n pairs of a sheet and a cube.
template <std::size_t axis>
Placer sheets(const Population& population) {
    const double thickness = 0.4 / count(population);
    const double side = std::min(8.0 / count(population), 0.5);
    return [=](std::uint64_t i) {
        RandomStream random(population.seed, i);
        const Point low = uniform_point(random);
        if (i % 20 != 0) return box_of(low, {side, side, side});
        Box3f box = world_size_box(random);
        box.min[axis] = float(low[axis]);
        box.max[axis] = float(low[axis] + thickness);
        return box;
    };
}

/// Rods; rod i lies along axis i mod 3. Two rods along different axes overlap if they overlap on the third axis: 2 n pairs.
Placer rods(const Population& population) {
    const double side = std::min(3.0 / count(population), 0.5);
    return [=](std::uint64_t i) {
        RandomStream random(population.seed, i);
        Box3f box = box_of(uniform_point(random), {side, side, side});
        box.min[i % 3] = float(random.uniform(0, 0.01));
        box.max[i % 3] = float(random.uniform(0.99, 1));
        return box;
    };
}

Placer far_outlier(const Population& population) {
    return [=, dust = uniform(population)](std::uint64_t i) {
        return i == population.objects / 2 ? Box3f{{1e5f, 1e5f, 1e5f}, {100001.f, 100001.f, 100001.f}} : dust(i);
    };
}

constexpr Kind kind_table[] = {
    {"uniform", "equal cubes anywhere in the unit cube, n/2 pairs", false, uniform},
    {"dense", "equal cubes anywhere in the unit cube, 5 n pairs", false, dense},
    {"mixed", "cubes whose sizes span three decades, 2.4 n pairs", false, mixed},
    {"clustered", "80% of the cubes in 20 Gaussian clusters, 2.5 n pairs", false, clustered},
    {"flat", "cubes in a world that is thin in z, 3 n/4 pairs", false, flat},
    {"world10", "uniform, but 10 boxes have the size of the world, 10.5 n pairs", false, world10},
    {"same-x", "all boxes have the same x interval, n/2 pairs", false, same_interval<0>},
    {"same-y", "all boxes have the same y interval, n/2 pairs", false, same_interval<1>},
    {"same-z", "all boxes have the same z interval, n/2 pairs", false, same_interval<2>},
    {"coincident", "all boxes are the same, n (n - 1) / 2 pairs", false, coincident},
    {"plates-x", "world-wide thin plates side by side along x, n/1000 pairs", false, plates<0>},
    {"plates-y", "world-wide thin plates side by side along y, n/1000 pairs", false, plates<1>},
    {"plates-z", "world-wide thin plates side by side along z, n/1000 pairs", false, plates<2>},
    {"sheets-x", "5% world-wide thin sheets normal to x among dust, 0.4 n pairs", false, sheets<0>},
    {"sheets-y", "5% world-wide thin sheets normal to y among dust, 0.4 n pairs", false, sheets<1>},
    {"sheets-z", "5% world-wide thin sheets normal to z among dust, 0.4 n pairs", false, sheets<2>},
    {"rods", "three interleaved families of thin world-long rods, 2 n pairs", false, rods},
    {"micro20", "20 uniform clusters of 1e-5 of the world, n/2 pairs", false, micro20},
    {"far-outlier", "uniform, but one box lies 100,000 worlds away, n/2 pairs", false, far_outlier},
    {"brownian", "uniform at first, then every object takes a small random step a frame", true, uniform},
};

}  // namespace

std::span<const Kind> all_kinds() { return kind_table; }

double cube_side(std::uint64_t objects, double pairs_per_object) {
    // There are n^2 / 2 pairs of objects; each overlaps with probability (2 side)^3.
    const double n = double(std::max<std::uint64_t>(objects, 1));
    return cube_root(2 * pairs_per_object / n) / 2;
}

}  // namespace octopair::samples
