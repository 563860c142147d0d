#include "scene/queries/box_distance.hpp"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace octopair {
namespace {

Gap gap_between(const Box3d& a, const Box3d& b, int axis) {
    if (a.min[axis] > b.max[axis]) return {a.min[axis], b.max[axis]};
    if (b.min[axis] > a.max[axis]) return {b.min[axis], a.max[axis]};
    return {};
}

Gaps gaps_between(const Box3d& a, const Box3d& b) {
    return {gap_between(a, b, 0), gap_between(a, b, 1), gap_between(a, b, 2)};
}

/// Returns the square root of the sum of squares. The squares may be beyond the range of float64.
double scaled_length(const std::array<double, 3>& gaps) {
    const double largest = std::max({gaps[0], gaps[1], gaps[2]});
    if (std::isinf(largest)) return largest;
    const double scale = largest > 1 ? 0x1p-600 : 0x1p600, back = largest > 1 ? 0x1p600 : 0x1p-600;
    double sum = 0;
    for (const double gap : gaps) sum += (gap * scale) * (gap * scale);
    return std::sqrt(sum) * back;
}

/// An unevaluated sum of two float64. `tail` is the rounding error of `head`.
struct Parts {
    double head, tail;
};

/// Returns the exact sum of two numbers (Knuth's TwoSum).
Parts add(double a, double b) {
    const double sum = a + b, b_part = sum - a;
    return {sum, (a - (sum - b_part)) + (b - b_part)};
}

/// Returns the exact square of a number (Dekker). Requires: `a` is within the range that careful_distance() requires.
Parts square(double a) {
    const double spread = 134217729 * a;  // 2^27 + 1
    const double high = spread - (spread - a), low = a - high;
    const double product = a * a;
    return {product, ((high * high - product) + 2 * high * low) + low * low};
}

struct Bounds {
    double low, high;
};

/// Returns bounds on the rounded distance, which are nearly always equal. Computes with twice the digits of float64: the
/// relative errors of the sum and of its root are below 2^-100. Requires: the largest gap is in [2^-400, 2^500].
Bounds careful_distance(const Gaps& gaps) {
    constexpr double error = 0x1p-90;
    double sum = 0, tail = 0;
    for (const Gap& gap : gaps) {
        const Parts width = add(gap.high, -gap.low);
        const Parts squared = square(width.head);
        const Parts next = add(sum, squared.head);
        sum = next.head;
        tail += next.tail + (squared.tail + 2 * width.head * width.tail);
    }
    const double root = std::sqrt(sum);
    const Parts squared = square(root);
    const double rest = ((sum - squared.head) - squared.tail) + tail;
    const double correction = rest / (2 * root);
    return {root + (correction - error * root), root + (correction + error * root)};
}

/// Returns the float64 nearest to the square root of the sum of squares. `guess`: a number near the root, where the search begins.
/// The bits of non-negative float64 numbers, read as integers, have the order of the numbers. So a step of the search is one bit pattern.
double nearest_root(const Gaps& gaps, double guess) {
    constexpr std::uint64_t infinity = 0x7FF0'0000'0000'0000;
    auto bits = std::bit_cast<std::uint64_t>(guess);
    const auto is_above = [&](std::uint64_t low) {
        const int sign = compare_root_with_middle(gaps, std::bit_cast<double>(low));
        return sign > 0 || (sign == 0 && (low & 1) != 0);
    };
    while (bits > 0 && !is_above(bits - 1)) --bits;
    while (bits < infinity && is_above(bits)) ++bits;
    return std::bit_cast<double>(bits);
}

}  // namespace

bool exactly_overlap(const Sphere& sphere, const Box3d& box) {
    Box3d centre;
    for (int axis = 0; axis < 3; ++axis) centre.min[axis] = centre.max[axis] = sphere.centre[axis];
    return compare_square_sums(gaps_between(centre, box), {Gap{sphere.radius, 0}}) <= 0;
}

int exactly_compare_distances(const Box3d& from, const Box3d& a, const Box3d& b) {
    return compare_square_sums(gaps_between(from, a), gaps_between(from, b));
}

double distance(const Box3d& a, const Box3d& b) {
    const Gaps gaps = gaps_between(a, b);
    std::array<double, 3> rounded;
    for (std::size_t axis = 0; axis < 3; ++axis) rounded[axis] = gaps[axis].high - gaps[axis].low;
    const double largest = std::max({rounded[0], rounded[1], rounded[2]});
    // If there is a gap on one axis only, its rounded difference is the rounded distance.
    if (std::count(rounded.begin(), rounded.end(), 0.0) >= 2) return largest;
    if (!(largest >= 0x1p-400 && largest <= 0x1p500)) return nearest_root(gaps, scaled_length(rounded));
    const Bounds bounds = careful_distance(gaps);
    return bounds.low == bounds.high ? bounds.low : nearest_root(gaps, bounds.low);
}

}  // namespace octopair
