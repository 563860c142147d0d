#include "io/meshes/gltf/node_pose.hpp"

#include <cmath>

#include "io/files/failure.hpp"
#include "io/meshes/gltf/fields.hpp"

namespace octopair::io::gltf {

namespace {

/// Returns the upper rows of a matrix. Its numbers are column by column.
Pose matrix_of(const JsonFields& node) {
    const auto numbers = numbers_or<16>(node, "matrix", {});
    constexpr std::array<double, 4> last_row = {0, 0, 0, 1};
    constexpr double rounding = 1e-5;  // of exporters that compute in float32
    Pose pose;
    for (std::size_t column = 0; column < 4; ++column) {
        if (!(std::abs(numbers[4 * column + 3] - last_row[column]) <= rounding))
            node.refuse_key("matrix", "the last row is not 0, 0, 0, 1");
        for (std::size_t row = 0; row < 3; ++row) pose.rows[row][column] = numbers[4 * column + row];
    }
    return pose;
}

}  // namespace

Pose pose_of(const Placement& placement, const std::string& place) {
    const auto& [x, y, z, w] = placement.rotation;
    for (const auto& numbers : {placement.translation, placement.scale}) {
        for (const double number : numbers) {
            if (!std::isfinite(number)) refuse(place, "the transform has the number " + number_text(number));
        }
    }
    const double length = std::hypot(std::hypot(x, y), std::hypot(z, w));
    if (!(length > 0) || !std::isfinite(length)) refuse(place, "the rotation has the length " + number_text(length));
    Pose pose = make_pose(placement.translation, {w, x, y, z});
    for (auto& row : pose.rows) {
        for (std::size_t axis = 0; axis < 3; ++axis) row[axis] *= placement.scale[axis];
    }
    return pose;
}

Pose node_pose(const JsonFields& node) {
    if (node.find("matrix") != nullptr) {
        for (const char* const key : {"translation", "rotation", "scale"}) {
            if (node.find(key) != nullptr)
                node.refuse_key(key, "the node has a matrix, too; only one of both is allowed");
        }
        return matrix_of(node);
    }
    Placement placement;
    placement.translation = numbers_or<3>(node, "translation", placement.translation);
    placement.rotation = numbers_or<4>(node, "rotation", placement.rotation);
    placement.scale = numbers_or<3>(node, "scale", placement.scale);
    return pose_of(placement, node.place());
}

}  // namespace octopair::io::gltf
