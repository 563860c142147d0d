// The poses of Assimp's nodes, with the axes of the file.
#include "io/meshes/assimp/mesh_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "io/formats/format_table.hpp"

namespace octopair::io {

namespace {

using Rows = std::array<std::array<double, 4>, 3>;

Rows rows_of(const aiMatrix4x4& m) {
    return {{{m.a1, m.a2, m.a3, m.a4}, {m.b1, m.b2, m.b3, m.b4}, {m.c1, m.c2, m.c3, m.c4}}};
}

std::array<double, 4> negated(const std::array<double, 4>& row) {
    std::array<double, 4> result;
    std::transform(row.begin(), row.end(), result.begin(), [](double number) { return number == 0 ? 0 : -number; });
    return result;
}

/// Reverts a change of axes. The function only swaps and negates numbers, so it rounds nothing.
Rows undo(AxisChange change, const Rows& rows) {
    if (change == AxisChange::turned) return {rows[0], negated(rows[2]), rows[1]};
    if (change == AxisChange::mirrored) return {rows[0], rows[1], negated(rows[2])};
    return rows;
}

/// Returns the float64 that is nearest to the shortest decimal number that rounds to `value`. For example 0.001f gives 0.001.
double shortest_decimal(float value) {
    const std::string text = fmt::format("{}", value);
    double decimal = double(value);
    (void)std::from_chars(text.data(), text.data() + text.size(), decimal);
    return decimal;
}

/// Removes the rounding errors of the quarter turn that Assimp applies to IFC models in float32. They leave 4e-8 where 0 belongs, and
/// change 0.001 by 5e-11.
void remove_rounding(Rows& rows) {
    double largest = 0;
    for (const auto& row : rows) largest = std::max({largest, std::abs(row[0]), std::abs(row[1]), std::abs(row[2])});
    for (auto& row : rows) {
        for (std::size_t column = 0; column < 3; ++column) {
            if (std::abs(row[column]) < 1e-7 * largest) row[column] = 0;
            row[column] = shortest_decimal(float(row[column]));
        }
    }
}

}  // namespace

BoundedPose pose_of(const aiNode& node) { return BoundedPose(rows_of(node.mTransformation)); }

BoundedPose root_pose(const aiNode& root, const KnownFormat& known) {
    if (known.format == nullptr) return pose_of(root);
    Rows rows = undo(known.format->axes, rows_of(root.mTransformation));
    if (known.format->name == "IFC") remove_rounding(rows);
    return BoundedPose(rows);
}

}  // namespace octopair::io
