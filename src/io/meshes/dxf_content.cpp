#include "io/meshes/dxf_content.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>

#include <fmt/format.h>

namespace octopair::io {

namespace {

std::string_view trimmed_line(std::string_view line) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return {};
    return line.substr(begin, line.find_last_not_of(" \t\r") - begin + 1);
}

/// A code and its value.
struct Group {
    int code = 0;
    std::string_view value;
    std::size_t line = 0;  // of the code

    /// Returns the value as a number; nan if it is none.
    double number() const {
        const std::string_view text = unsigned_text();
        double number = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
        const bool is_number = error == std::errc() && end == text.data() + text.size();
        return is_number ? number : std::numeric_limits<double>::quiet_NaN();
    }
    /// Returns the whole number at the beginning of the value; 0 if there is none.
    int whole() const {
        const std::string_view text = unsigned_text();
        int number = 0;
        std::from_chars(text.data(), text.data() + text.size(), number);
        return number;
    }

private:
    std::string_view unsigned_text() const { return value.starts_with('+') ? value.substr(1) : value; }
};

class GroupReader {
public:
    explicit GroupReader(std::string_view text) : rest_(text) {}

    std::optional<Group> next() {
        Group group;
        group.line = line_ + 1;
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

using Numbers3 = std::array<double, 3>;

/// Sets the coordinate of a point whose x has the code `first`. The codes of y and z are 10 and 20 greater.
void set_point(Numbers3& point, int first, const Group& group) {
    for (int axis = 0; axis < 3; ++axis) {
        if (group.code == first + 10 * axis) point[std::size_t(axis)] = group.number();
    }
}

struct Block {
    std::string_view name, name_for_assimp;
    Numbers3 base{}, base_for_assimp{};
    bool surfaces = false;  // has something that Assimp reads
    std::uint64_t left_out = 0;
};

struct Insert {
    std::string_view block;
    std::size_t line = 0;
    Numbers3 position{}, scale{1, 1, 1}, extrusion{0, 0, 1};
    double angle = 0, copies = 1;
};

bool is_read(std::string_view entity) {
    constexpr std::array<std::string_view, 6> read = {"3DFACE", "LINE", "3DLINE", "POLYLINE", "VERTEX", "SEQEND"};
    return std::find(read.begin(), read.end(), entity) != read.end();
}

bool has_surfaces(std::string_view entity) {
    constexpr std::array<std::string_view, 12> surfaces = {"3DSOLID",
                                                           "BODY",
                                                           "REGION",
                                                           "SURFACE",
                                                           "EXTRUDEDSURFACE",
                                                           "LOFTEDSURFACE",
                                                           "REVOLVEDSURFACE",
                                                           "SWEPTSURFACE",
                                                           "PLANESURFACE",
                                                           "NURBSURFACE",
                                                           "MESH",
                                                           "SOLID"};
    return std::find(surfaces.begin(), surfaces.end(), entity) != surfaces.end();
}

class FaultSearch {
public:
    DxfFaults find(std::string_view text) {
        GroupReader reader(text);
        while (const auto group = reader.next()) add(*group);
        for (const Insert& insert : inserts_) judge(insert);
        for (const auto& [what, count] : lost_) faults_.lost.push_back(fmt::format("{} ({})", what, count));
        return std::move(faults_);
    }

private:
    void add(const Group& group) {
        if (group.code == 0) return begin_entity(group);
        if (section_.empty() && entity_ == "SECTION" && group.code == 2) section_ = group.value;
        if (section_ == "BLOCKS" && !blocks_.empty()) return add_to_block(group);
        if (section_ == "ENTITIES" && entity_ == "INSERT") return add_to_insert(group);
        check_polyline(group);
    }

    void begin_entity(const Group& group) {
        entity_ = group.value;
        if (entity_ == "ENDSEC" || entity_ == "SECTION") section_ = {};
        if (section_ == "BLOCKS") begin_in_block();
        if (section_ != "ENTITIES") return;
        if (entity_ == "INSERT") inserts_.push_back({{}, group.line});
        if (has_surfaces(entity_)) ++lost_[fmt::format("entities of type {}", entity_)];
    }

    void begin_in_block() {
        if (entity_ == "BLOCK") {
            blocks_.emplace_back();
            skipping_ = false;
            return;
        }
        if (blocks_.empty() || entity_ == "ENDBLK") return;
        skipping_ |= entity_ == "INSERT";
        Block& block = blocks_.back();
        if (skipping_ || has_surfaces(entity_)) {
            ++block.left_out;
        } else {
            block.surfaces |= is_read(entity_);
        }
    }

    void add_to_block(const Group& group) {
        Block& block = blocks_.back();
        if (entity_ == "BLOCK") {
            if (group.code == 2) block.name = block.name_for_assimp = group.value;
            set_point(block.base, 10, group);
            set_point(block.base_for_assimp, 10, group);
        } else if (is_read(entity_)) {
            if (!skipping_) check_polyline(group);
        } else if (!skipping_ && entity_ != "ENDBLK") {
            if (group.code == 2) block.name_for_assimp = group.value;
            set_point(block.base_for_assimp, 10, group);
        }
    }

    void add_to_insert(const Group& group) {
        Insert& insert = inserts_.back();
        if (group.code == 2) insert.block = group.value;
        set_point(insert.position, 10, group);
        set_point(insert.extrusion, 210, group);
        if (group.code >= 41 && group.code <= 43) insert.scale[std::size_t(group.code - 41)] = group.number();
        if (group.code == 50) insert.angle = group.number();
        if (group.code == 70 || group.code == 71) insert.copies *= group.number() < 1 ? 1 : group.number();
    }

    void check_polyline(const Group& group) {
        if (entity_ == "POLYLINE" && group.code == 70 && (group.whole() & 16) != 0)
            ++lost_["meshes of M x N points (POLYLINE)"];
        if (entity_ == "VERTEX" && group.code >= 71 && group.code <= 74 && group.whole() < 0)
            ++lost_["corners of polyface meshes, after invisible edges"];
    }

    void judge(const Insert& insert) {
        const auto found = std::find_if(blocks_.begin(), blocks_.end(),
                                        [&](const Block& block) { return block.name == insert.block; });
        if (found == blocks_.end()) {
            ++lost_[fmt::format("inserts of block '{}', which Assimp does not find", insert.block)];
            return;
        }
        if (found->left_out > 0) lost_[fmt::format("entities of block '{}'", found->name)] = found->left_out;
        if (!found->surfaces) return;
        if (found->name_for_assimp != found->name) {
            ++lost_[fmt::format("inserts of block '{}'", found->name)];
            return;
        }
        if (!is_placed_rightly(insert, *found))
            set_wrong(insert.line, fmt::format("the block '{}' is inserted with a scale, a rotation, a base or copies",
                                               insert.block));
    }

    /// Assimp moves by -base, then position times scale; right is position minus base times scale.
    static bool is_placed_rightly(const Insert& insert, const Block& block) {
        if (std::fmod(insert.angle, 360) != 0 || insert.copies != 1 || insert.extrusion != Numbers3{0, 0, 1})
            return false;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double scale = insert.scale[axis];
            const double error =
                (scale - 1) * insert.position[axis] + scale * block.base[axis] - block.base_for_assimp[axis];
            if (!(error == 0)) return false;  // nan: a number of it is not understood
        }
        return true;
    }

    void set_wrong(std::size_t line, std::string what) {
        if (faults_.wrong.empty()) faults_.wrong = fmt::format("line {}: {}", line, what);
    }

    std::string_view section_, entity_;
    bool skipping_ = false;  // in a block, after an INSERT
    std::vector<Block> blocks_;
    std::vector<Insert> inserts_;
    std::map<std::string, std::uint64_t> lost_;
    DxfFaults faults_;
};

}  // namespace

DxfFaults find_dxf_faults(std::string_view text) { return FaultSearch().find(text); }

}  // namespace octopair::io
