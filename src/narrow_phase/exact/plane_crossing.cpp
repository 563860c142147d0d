#include "narrow_phase/exact/plane_crossing.hpp"

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstddef>

#include "geometry/exact_integer.hpp"

namespace octopair {
namespace {

using Integer = boost::multiprecision::number<boost::multiprecision::cpp_int_backend<>, boost::multiprecision::et_off>;
using IntegerPoint = std::array<Integer, 3>;

/// A height in float64 is accepted if it is larger than its error bound by this factor: 30 of its 53 bits are right.
constexpr double min_value_per_error = 0x1p30;

struct RoundedHeight {
    double value, error;
    bool is_sure() const { return std::abs(value) > min_value_per_error * error; }
};

RoundedHeight rounded_height(const Triangle3d& triangle, const Point3d& place) {
    Point3d b, c, d;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        b[axis] = triangle[1][axis] - triangle[0][axis];
        c[axis] = triangle[2][axis] - triangle[0][axis];
        d[axis] = place[axis] - triangle[0][axis];
    }
    RoundedHeight height = {0, filter::underflow};
    for (std::size_t i = 0; i < 3; ++i) {
        const double left = b[(i + 1) % 3] * c[(i + 2) % 3], right = b[(i + 2) % 3] * c[(i + 1) % 3];
        height.value += d[i] * (left - right);
        height.error += filter::plane_error * std::abs(d[i]) * (std::abs(left) + std::abs(right)) +
                        filter::underflow * std::abs(d[i]);
    }
    return height;
}

RoundedHeight rounded_height(const ProjectedLine& line, const Point3d& place) {
    const unsigned u = (line.axis + 1) % 3, v = (line.axis + 2) % 3;
    const double left = (line.b[u] - line.a[u]) * (place[v] - line.a[v]);
    const double right = (line.b[v] - line.a[v]) * (place[u] - line.a[u]);
    return {left - right, filter::line_error * (std::abs(left) + std::abs(right)) + filter::underflow};
}

/// Returns begin / (begin - end), for the heights of two ends. Requires: `begin` and `end` have different signs.
double part_of(Integer begin, Integer end) {
    begin = abs(begin), end = abs(end);
    Integer whole = begin + end;
    if (whole.is_zero()) return 0;
    constexpr unsigned enough = 128;
    const auto width = unsigned(msb(whole));
    if (width > enough) begin >>= width - enough, whole >>= width - enough;
    return begin.convert_to<double>() / whole.convert_to<double>();
}

template <std::size_t count>
class IntegerPoints {
public:
    explicit IntegerPoints(const std::array<const Point3d*, count>& points) : grid_(numbers_of(points)) {}

    /// Returns point i minus point 0.
    IntegerPoint from_first(std::size_t i) const {
        IntegerPoint way;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            way[axis] = grid_.template at<Integer>(3 * i + axis) - grid_.template at<Integer>(axis);
        }
        return way;
    }

private:
    static std::array<double, 3 * count> numbers_of(const std::array<const Point3d*, count>& points) {
        std::array<double, 3 * count> numbers;
        for (std::size_t i = 0; i < 3 * count; ++i) numbers[i] = (*points[i / 3])[i % 3];
        return numbers;
    }

    DyadicGrid<3 * count> grid_;
};

Integer cross(const IntegerPoint& a, const IntegerPoint& b, std::size_t axis) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    return a[u] * b[v] - a[v] * b[u];
}

}  // namespace

double part_to_plane(const Triangle3d& triangle, const Point3d& begin, const Point3d& end) {
    const RoundedHeight from = rounded_height(triangle, begin), to = rounded_height(triangle, end);
    if (from.is_sure() && to.is_sure()) return from.value / (from.value - to.value);
    const IntegerPoints<5> points({&triangle[0], &triangle[1], &triangle[2], &begin, &end});
    const IntegerPoint b = points.from_first(1), c = points.from_first(2);
    const IntegerPoint begin_way = points.from_first(3), end_way = points.from_first(4);
    Integer begin_height = 0, end_height = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const Integer normal = cross(b, c, axis);
        begin_height += normal * begin_way[axis];
        end_height += normal * end_way[axis];
    }
    return part_of(begin_height, end_height);
}

double part_to_line(const ProjectedLine& line, const Point3d& begin, const Point3d& end) {
    const RoundedHeight from = rounded_height(line, begin), to = rounded_height(line, end);
    if (from.is_sure() && to.is_sure()) return from.value / (from.value - to.value);
    const IntegerPoints<4> points({&line.a, &line.b, &begin, &end});
    const IntegerPoint b = points.from_first(1);
    return part_of(cross(b, points.from_first(2), line.axis), cross(b, points.from_first(3), line.axis));
}

}  // namespace octopair
