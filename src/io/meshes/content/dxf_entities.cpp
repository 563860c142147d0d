#include "io/meshes/content/dxf_entities.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/content/number_list.hpp"

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
    /// Puts the entity that was read where it belongs.
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
    DxfEntity entity_;           // that is being read
    DxfBlock* block_ = nullptr;  // that is being read
};

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

}  // namespace octopair::io
