#include "support/kinds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "samples/random.hpp"
#include "samples/scenes.hpp"

namespace octopair::test {

namespace {

using samples::RandomStream;

/// Function that makes a random box of a kind.
template <typename Real>
using MakeBox = Box<Real> (*)(RandomStream&);

/// An interval on an axis.
struct Span {
    double low, extent;
};

/// Makes a box of the spans that `span_on` returns for the axes.
template <typename Real, typename SpanOn>
Box<Real> span_box(const SpanOn& span_on) {
    Box<Real> box;
    for (int axis = 0; axis < 3; ++axis) {
        const Span span = span_on(axis);
        box.min[axis] = Real(span.low);
        box.max[axis] = std::max(Real(span.low + span.extent), box.min[axis]);
    }
    return box;
}

/// Corners on a small lattice of integers: faces, edges and corners often touch. Extents are often zero.
template <typename Real>
Box<Real> lattice(RandomStream& random) {
    Box<Real> box;
    for (int axis = 0; axis < 3; ++axis) {
        const auto low = random.below(17), extent = random.below(4);
        box.min[axis] = Real(low);
        box.max[axis] = Real(low + extent);
    }
    return box;
}

/// Few different boxes, each with many copies.
template <typename Real>
Box<Real> duplicates(RandomStream& random) {
    RandomStream few(random.below(5), 77);
    return lattice<Real>(few);
}

/// Zero extent on `axes` of the three axes, from a random axis on. Coordinates repeat.
template <typename Real, int axes>
Box<Real> collapsed(RandomStream& random) {
    Box<Real> box;
    const auto first = random.below(3);
    for (int k = 0; k < 3; ++k) {
        const auto axis = (first + std::uint64_t(k)) % 3;
        box.min[axis] = Real(double(random.below(40)) / 8);
        box.max[axis] = k < axes ? box.min[axis] : box.min[axis] + Real(random.uniform(0, 2));
    }
    return box;
}

/// Nearly every box is as large as the world.
template <typename Real>
Box<Real> giants(RandomStream& random) {
    const bool dust = random.below(8) == 0;
    return span_box<Real>([&](int) {
        return Span{dust ? random.uniform() : random.uniform(0, 0.05),
                    dust ? random.uniform(0, 0.01) : random.uniform(0.9, 1)};
    });
}

/// Coordinates k / 2^n, which are borders of octants, or the next number above or below.
template <typename Real>
Box<Real> borders(RandomStream& random) {
    const auto border = [&] {
        const double cells = double(1u << random.below(8));
        const Real x = Real(double(random.below(std::uint64_t(cells) + 1)) / cells);
        switch (random.below(4)) {
            case 0:
                return std::nextafter(x, Real(2));
            case 1:
                return std::nextafter(x, Real(-1));
            default:
                return x;
        }
    };
    Box<Real> box;
    for (int axis = 0; axis < 3; ++axis) {
        const Real a = border(), b = random.below(3) == 0 ? a : border();
        const bool small = std::abs(b - a) < Real(0.3);
        box.min[axis] = small ? std::min(a, b) : a;
        box.max[axis] = small ? std::max(a, b) : a;
    }
    return box;
}

/// Zeros of both signs and their neighbours.
template <typename Real>
Box<Real> signed_zeros(RandomStream& random) {
    constexpr Real tiny = std::numeric_limits<Real>::denorm_min();
    const Real values[] = {Real(-1), -tiny, Real(-0.0), Real(0.0), tiny, Real(1)};
    Box<Real> box;
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = random.below(6), b = random.below(6);
        box.min[axis] = values[std::min(a, b)];
        box.max[axis] = values[std::max(a, b)];
    }
    return box;
}

/// A world a few hundred denormal steps wide.
template <typename Real>
Box<Real> denormals(RandomStream& random) {
    constexpr Real step = std::numeric_limits<Real>::denorm_min();
    Box<Real> box;
    for (int axis = 0; axis < 3; ++axis) {
        const auto low = random.below(300);
        box.min[axis] = (Real(low) - 150) * step;
        box.max[axis] = (Real(low + random.below(40)) - 150) * step;
    }
    return box;
}

/// A world from -max to max of the type.
template <typename Real>
Box<Real> largest(RandomStream& random) {
    constexpr Real max = std::numeric_limits<Real>::max();
    Box<Real> box;
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = Real(random.uniform(-1, 1)), b = a + Real(random.uniform(0, 0.3));
        box.min[axis] = random.below(20) == 0 ? -max : max * a;
        box.max[axis] = random.below(20) == 0 ? max : max * std::min(b, Real(1));
    }
    return box;
}

/// A world of size 64, at 10 or -10 million on every axis: in float32 all coordinates are whole numbers.
template <typename Real>
Box<Real> far_origin(RandomStream& random) {
    return span_box<Real>([&](int axis) {
        return Span{(axis == 1 ? -1e7 : 1e7) + random.uniform(0, 64), random.uniform(0, 8)};
    });
}

/// Sizes over 6 decades, independent on each axis.
template <typename Real>
Box<Real> decades(RandomStream& random) {
    return span_box<Real>([&](int) {
        return Span{random.uniform(), random.uniform(1, 2) / double(1u << random.below(21))};
    });
}

/// One object in 40 is a point far away, at up to a quarter of the largest number. All others are near the unit cube.
template <typename Real>
Box<Real> outliers(RandomStream& random) {
    if (random.below(40) == 0) {
        const Real far = Real(random.uniform(-1, 1)) * std::numeric_limits<Real>::max() / 4;
        return {{far, far, far}, {far, far, far}};
    }
    return span_box<Real>([&](int) { return Span{random.uniform(), random.uniform(0, 0.2)}; });
}

/// Thin crossings of every shape: on each axis a box is a point, thin, or as wide as the world.
template <typename Real>
Box<Real> crossings(RandomStream& random) {
    return span_box<Real>([&](int) {
        const auto shape = random.below(3);
        const double low = shape == 2 ? random.uniform(0, 0.02) : random.uniform();
        const double extent = shape == 0 ? 0 : shape == 1 ? random.uniform(0, 0.02) : random.uniform(0.9, 0.98);
        return Span{low, extent};
    });
}

struct OwnKind {
    const char* name;
    MakeBox<float> make_float;
    MakeBox<double> make_double;
};

constexpr OwnKind own_kinds[] = {
    {"lattice", lattice<float>, lattice<double>},
    {"duplicates", duplicates<float>, duplicates<double>},
    {"rectangles", collapsed<float, 1>, collapsed<double, 1>},
    {"segments", collapsed<float, 2>, collapsed<double, 2>},
    {"points", collapsed<float, 3>, collapsed<double, 3>},
    {"giants", giants<float>, giants<double>},
    {"borders", borders<float>, borders<double>},
    {"signed-zeros", signed_zeros<float>, signed_zeros<double>},
    {"denormals", denormals<float>, denormals<double>},
    {"largest", largest<float>, largest<double>},
    {"far-origin", far_origin<float>, far_origin<double>},
    {"decades", decades<float>, decades<double>},
    {"outliers", outliers<float>, outliers<double>},
    {"crossings", crossings<float>, crossings<double>},
};

const OwnKind* find_own(const std::string& name) {
    const auto found = std::find_if(std::begin(own_kinds), std::end(own_kinds),
                                    [&](const OwnKind& kind) { return kind.name == name; });
    return found == std::end(own_kinds) ? nullptr : found;
}

template <typename Real>
std::vector<Box<Real>> make_own(MakeBox<Real> make, std::uint64_t objects, std::uint64_t seed) {
    std::vector<Box<Real>> boxes;
    boxes.reserve(objects);
    for (std::uint64_t i = 0; i < objects; ++i) {
        RandomStream random(seed, i);
        boxes.push_back(make(random));
    }
    return boxes;
}

}  // namespace

std::vector<std::string> sample_kind_names() {
    const auto kinds = samples::scene_kinds();
    return {kinds.begin(), kinds.end()};
}

std::vector<std::string> all_kind_names() {
    std::vector<std::string> names = sample_kind_names();
    for (const OwnKind& kind : own_kinds) names.emplace_back(kind.name);
    return names;
}

std::vector<Box3f> make_boxes(const std::string& kind, std::uint64_t objects, std::uint64_t seed) {
    const OwnKind* own = find_own(kind);
    return own ? make_own(own->make_float, objects, seed) : samples::make_scene(kind, objects, seed);
}

std::vector<Box3d> make_double_boxes(const std::string& kind, std::uint64_t objects, std::uint64_t seed) {
    if (const OwnKind* own = find_own(kind)) return make_own(own->make_double, objects, seed);
    std::vector<Box3d> boxes = widened(samples::make_scene(kind, objects, seed));
    // Fill the bits that float32 lacks: ends that were equal or touched are then slightly apart.
    for (std::uint64_t i = 0; i < objects; ++i) {
        RandomStream random(~seed, i);
        for (int axis = 0; axis < 3; ++axis) {
            boxes[i].min[axis] *= 1 - 1e-9 * random.uniform();
            boxes[i].max[axis] = std::max(boxes[i].max[axis] * (1 + 1e-9 * random.uniform(-1, 1)), boxes[i].min[axis]);
        }
    }
    return boxes;
}

std::vector<Box3d> widened(const std::vector<Box3f>& boxes) {
    std::vector<Box3d> wide;
    wide.reserve(boxes.size());
    for (const Box3f& box : boxes) {
        wide.push_back({{box.min[0], box.min[1], box.min[2]}, {box.max[0], box.max[1], box.max[2]}});
    }
    return wide;
}

// Not inlined: where g++ 12 vectorises double(float(x)), g++ leaves both conversions out.
[[gnu::noinline]] Box3f narrowed(const Box3d& box) {
    Box3f narrow;
    for (int axis = 0; axis < 3; ++axis) {
        narrow.min[axis] = float(box.min[axis]);
        narrow.max[axis] = float(box.max[axis]);
    }
    return narrow;
}

Box3d rounded_to_float32(const Box3d& box) { return widened({narrowed(box)}).front(); }

std::string param_name(const ::testing::TestParamInfo<std::string>& info) {
    std::string name = info.param;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

}  // namespace octopair::test
