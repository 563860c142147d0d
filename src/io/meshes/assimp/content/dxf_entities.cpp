#include "io/meshes/assimp/content/dxf_entities.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/text_words.hpp"

namespace octopair::io {

namespace {

std::string_view trimmed_line(std::string_view line) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return {};
    return line.substr(begin, line.find_last_not_of(" \t\r") - begin + 1);
}

class GroupReader {
public:
    explicit GroupReader(std::string_view text) : rest_(text) {}

    /// Returns the number of the line that was read last.
    std::size_t line() const { return line_; }

    std::optional<DxfGroup> next() {
        DxfGroup group;
        const auto code = take_line();
        const auto value = take_line();
        if (!value) return std::nullopt;
        std::from_chars(code->data(), code->data() + code->size(), group.code);
        group.value = *value;
        return group;
    }

private:
    std::optional<std::string_view> take_line() {
        if (rest_.empty()) return std::nullopt;
        const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
        const std::string_view line = trimmed_line(rest_.substr(0, end));
        const std::size_t mark = rest_.substr(end).starts_with("\r\n") ? 2 : 1;
        rest_.remove_prefix(std::min(end + mark, rest_.size()));
        ++line_;
        return line;
    }

    std::string_view rest_;
    std::size_t line_ = 0;
};

class DxfParser {
public:
    DxfParser(const std::string& path, std::string_view text) : path_(path), reader_(text) {}

    DxfFile parse() {
        while (const auto group = reader_.next()) {
            if (group->code == 0) {
                end_entity();
                entity_.type = group->value;
                entity_.line = reader_.line();
                if (group->value == "EOF") {
                    file_.ends = true;
                    break;
                }
            } else if (entity_.type == "SECTION" && group->code == 2) {
                section_ = group->value;
            } else if (section_ == "BLOCKS" || section_ == "ENTITIES") {
                entity_.groups.push_back(*group);
            }
        }
        end_entity();
        if (section_ == "BLOCKS" || section_ == "ENTITIES")
            refuse(path_, fmt::format("is cut: the section {} has no ENDSEC; export the file again", section_));
        return std::move(file_);
    }

private:
    /// Adds the entity that was read to its block, or to the entities of the file. Begins or ends a block or a section.
    void end_entity() {
        DxfEntity entity = std::move(entity_);
        entity_ = {};
        if (entity.type == "SECTION") return;
        if (entity.type == "ENDSEC") {
            section_ = {};
        } else if (entity.type == "BLOCK") {
            const std::string name(entity.text(2));
            block_ = &file_.blocks[name];
            *block_ = {std::move(entity), {}};
        } else if (entity.type == "ENDBLK") {
            block_ = nullptr;
        } else if (section_ == "BLOCKS" && block_ != nullptr) {
            block_->entities.push_back(std::move(entity));
        } else if (section_ == "ENTITIES" && !entity.type.empty()) {
            file_.entities.push_back(std::move(entity));
        }
    }

    const std::string& path_;
    GroupReader reader_;
    DxfFile file_;
    std::string_view section_;
    DxfEntity entity_;           // the entity that is being read
    DxfBlock* block_ = nullptr;  // the block that is being read
};

DxfPoint cross_of(const DxfPoint& a, const DxfPoint& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

DxfPoint unit_of(const DxfPoint& vector) {
    const double length = std::hypot(vector[0], vector[1], vector[2]);
    return {vector[0] / length, vector[1] / length, vector[2] / length};
}

}  // namespace

std::string_view DxfEntity::text(int code) const {
    const auto found =
        std::find_if(groups.begin(), groups.end(), [&](const DxfGroup& group) { return group.code == code; });
    return found == groups.end() ? std::string_view() : found->value;
}

bool DxfEntity::has(int code) const {
    return std::any_of(groups.begin(), groups.end(), [&](const DxfGroup& group) { return group.code == code; });
}

double DxfEntity::number(int code, double otherwise, const std::string& path) const {
    if (!has(code)) return otherwise;
    const NumberList list = numbers_with_commas_of(text(code));
    if (list.numbers.size() != 1)
        refuse(path, fmt::format("line {}: {} has '{}' as group {}, which is no number", line, shown(type),
                                 shown(text(code)), code));
    return list.numbers[0];
}

int DxfEntity::whole(int code, int otherwise, const std::string& path) const {
    const double value = number(code, otherwise, path);
    if (!(std::abs(value) < 1e9))
        refuse(path, fmt::format("line {}: {} has '{}' as group {}, which is too large", line, shown(type),
                                 shown(text(code)), code));
    return int(value);
}

DxfPoint DxfEntity::point(int first, const DxfPoint& otherwise, const std::string& path) const {
    DxfPoint point{};
    for (int axis = 0; axis < 3; ++axis)
        point[std::size_t(axis)] = number(first + 10 * axis, otherwise[std::size_t(axis)], path);
    return point;
}

DxfFile DxfFile::parse(const std::string& path, std::string_view text) { return DxfParser(path, text).parse(); }

DxfTransform DxfTransform::move(const DxfPoint& by) {
    return DxfTransform({{{1, 0, 0, by[0]}, {0, 1, 0, by[1]}, {0, 0, 1, by[2]}}});
}

DxfTransform DxfTransform::scale(const DxfPoint& by) {
    return DxfTransform({{{by[0], 0, 0, 0}, {0, by[1], 0, 0}, {0, 0, by[2], 0}}});
}

DxfTransform DxfTransform::turn(double degrees) {
    double sine = 0, cosine = 1;
    const double quarters = std::remainder(degrees, 360) / 90;
    if (quarters == std::round(quarters)) {  // quarter turns are exact, without the rounding errors of sine and cosine
        constexpr std::array<double, 5> sines = {0, -1, 0, 1, 0}, cosines = {-1, 0, 1, 0, -1};
        sine = sines[std::size_t(quarters + 2)];
        cosine = cosines[std::size_t(quarters + 2)];
    } else {
        sine = std::sin(degrees * std::numbers::pi / 180);
        cosine = std::cos(degrees * std::numbers::pi / 180);
    }
    return DxfTransform({{{cosine, -sine, 0, 0}, {sine, cosine, 0, 0}, {0, 0, 1, 0}}});
}

DxfTransform DxfTransform::from_entity(const DxfPoint& extrusion) {
    if (extrusion[0] == 0 && extrusion[1] == 0 && extrusion[2] >= 0) return {};
    const DxfPoint z = unit_of(extrusion);
    const bool near_z = std::abs(z[0]) < 1.0 / 64 && std::abs(z[1]) < 1.0 / 64;
    const DxfPoint x = unit_of(cross_of(near_z ? DxfPoint{0, 1, 0} : DxfPoint{0, 0, 1}, z)), y = cross_of(z, x);
    return DxfTransform({{{x[0], y[0], z[0], 0}, {x[1], y[1], z[1], 0}, {x[2], y[2], z[2], 0}}});
}

DxfTransform DxfTransform::operator*(const DxfTransform& first) const {
    Rows product{};
    for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t column = 0; column < 4; ++column) {
            for (std::size_t k = 0; k < 3; ++k) product[row][column] += rows_[row][k] * first.rows_[k][column];
        }
        product[row][3] += rows_[row][3];
    }
    return DxfTransform(product);
}

DxfPoint DxfTransform::operator*(const DxfPoint& point) const {
    DxfPoint moved{};
    for (std::size_t row = 0; row < 3; ++row)
        moved[row] = rows_[row][0] * point[0] + rows_[row][1] * point[1] + rows_[row][2] * point[2] + rows_[row][3];
    return moved;
}

}  // namespace octopair::io
