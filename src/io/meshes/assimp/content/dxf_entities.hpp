// Entities and blocks of a DXF text, and DxfTransform: where the entities of a block are in the world.
#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace octopair::io {

using DxfPoint = std::array<double, 3>;

/// The smallest unit of a DXF text: a code, which gives the meaning, and a value.
struct DxfGroup {
    int code = 0;
    std::string_view value;
};

/// An entity, such as 3DFACE, with its groups. Requires: the text outlives the entity.
class DxfEntity {
public:
    std::string_view type;
    std::size_t line = 0;  ///< line of the type
    std::vector<DxfGroup> groups;

    /// Returns the value of the first group with a code, or an empty text.
    std::string_view text(int code) const;
    bool has(int code) const;
    /// Returns the value of the first group with a code. Throws: Error{bad_input} with the line if it is no number.
    double number(int code, double otherwise, const std::string& path) const;
    int whole(int code, int otherwise, const std::string& path) const;
    /// Returns the point whose x has the code `first`. The codes of y and z are 10 and 20 greater.
    DxfPoint point(int first, const DxfPoint& otherwise, const std::string& path) const;
};

struct DxfBlock {
    DxfEntity head;
    std::vector<DxfEntity> entities;
};

/// The blocks and the entities of a file.
struct DxfFile {
    std::map<std::string, DxfBlock, std::less<>> blocks;
    std::vector<DxfEntity> entities;
    bool ends = false;  ///< true if the file has its end mark

    /// Parses a DXF text. Requires: `text` outlives the result. `path` is for messages.
    /// Throws: Error{bad_input} if a section with entities does not end, because the file is cut.
    static DxfFile parse(const std::string& path, std::string_view text);
};

class DxfTransform {
public:
    /// Returns the transform that changes nothing.
    DxfTransform() = default;
    static DxfTransform move(const DxfPoint& by);
    static DxfTransform scale(const DxfPoint& by);
    /// Returns the rotation around z by an angle.
    static DxfTransform turn(double degrees);
    /// Returns the transform from an entity's coordinates to world coordinates, for its direction of extrusion (arbitrary axis
    /// algorithm). For a direction of length 0, returns the transform that changes nothing.
    static DxfTransform from_entity(const DxfPoint& extrusion);

    DxfTransform operator*(const DxfTransform& first) const;
    DxfPoint operator*(const DxfPoint& point) const;

private:
    using Rows = std::array<std::array<double, 4>, 3>;
    explicit DxfTransform(const Rows& rows) : rows_(rows) {}

    Rows rows_ = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
};

}  // namespace octopair::io
