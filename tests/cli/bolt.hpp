// A bolt in a plate, as an OBJ file.
#pragma once

#include <cmath>
#include <numbers>
#include <string>

namespace octopair::test {

/// Returns a bolt of radius 1 in a plate with a hole, both prisms of 24 sides. A hole of less than 1 holds the bolt on all sides: it can only
/// leave along its axis, which is a long way.
inline std::string bolt_in_plate(double hole) {
    constexpr int count = 24;
    std::string text = "o bolt\n";
    const auto circle = [&](double radius, double z) {
        for (int i = 0; i < count; ++i) {
            const double angle = 2 * std::numbers::pi * i / count;
            text += "v " + std::to_string(radius * std::cos(angle)) + ' ' + std::to_string(radius * std::sin(angle)) +
                    ' ' + std::to_string(z) + '\n';
        }
    };
    const auto sides = [&](int low, int high) {
        for (int i = 1; i <= count; ++i) {
            const int next = i % count + 1;
            text += "f " + std::to_string(low + i) + ' ' + std::to_string(low + next) + ' ' +
                    std::to_string(high + next) + ' ' + std::to_string(high + i) + '\n';
        }
    };
    circle(1, -3), circle(1, 3);
    sides(0, count);
    for (const bool top : {false, true}) {
        text += "f";
        for (int i = 1; i <= count; ++i) text += ' ' + std::to_string(top ? count + i : count + 1 - i);
        text += '\n';
    }
    text += "o plate\n";
    circle(4, 0), circle(4, 1), circle(hole, 0), circle(hole, 1);
    sides(2 * count, 3 * count), sides(5 * count, 4 * count), sides(4 * count, 2 * count), sides(3 * count, 5 * count);
    return text;
}

}  // namespace octopair::test
