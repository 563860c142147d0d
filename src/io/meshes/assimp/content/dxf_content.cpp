// Checks DXF files, and writes them in a form that Assimp reads rightly (correct_dxf()).
#include "io/meshes/assimp/content/mesh_content.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <iterator>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/assimp/content/dxf_entities.hpp"

namespace octopair::io {

namespace {

using DxfPoints = std::vector<DxfPoint>;

/// Flags of POLYLINE (group 70).
enum PolylineFlag : int { closed = 1, in_space = 8, grid = 16, closed_along_n = 32, polyface = 64 };
/// Flags of VERTEX (group 70).
enum VertexFlag : int { frame_control = 16, mesh_vertex = 64, face_record = 128 };

bool has_surfaces(std::string_view type) {
    constexpr std::array<std::string_view, 13> surfaces = {
        "3DSOLID",      "BODY",         "REGION",      "SURFACE", "EXTRUDEDSURFACE", "LOFTEDSURFACE", "REVOLVEDSURFACE",
        "SWEPTSURFACE", "PLANESURFACE", "NURBSURFACE", "MESH",    "SOLID",           "TRACE"};
    return std::find(surfaces.begin(), surfaces.end(), type) != surfaces.end();
}

/// Appends faces and lines to a DXF text.
class DxfWriter {
public:
    DxfWriter() { text_ = "0\nSECTION\n2\nENTITIES\n"; }

    /// Appends a line (2 corners) or a face (3 or 4 corners). Requires: 2 to 4 corners.
    void add(std::string_view layer, std::span<const DxfPoint> corners) {
        text_.append(corners.size() == 2 ? "0\nLINE\n8\n" : "0\n3DFACE\n8\n");
        // If a value begins with a brace, Assimp skips the entities after it. So a parenthesis replaces the brace.
        if (layer.starts_with('{')) {
            text_.append("(").append(layer.substr(1));
        } else {
            text_.append(layer);
        }
        text_ += '\n';
        for (std::size_t k = 0; k < corners.size(); ++k) {
            for (std::size_t axis = 0; axis < 3; ++axis)
                fmt::format_to(std::back_inserter(text_), "{}\n{}\n", 10 * (axis + 1) + k, corners[k][axis]);
        }
    }

    std::size_t size() const { return text_.size(); }
    std::string take() { return std::move(text_.append("0\nENDSEC\n0\nEOF\n")); }

private:
    std::string text_;
};

/// Place of entities in the world, and the blocks that contain them.
struct DxfPlace {
    DxfTransform transform;
    std::vector<std::string_view> blocks;  ///< from the outermost to the innermost block
};

class DxfExpansion {
public:
    DxfExpansion(const std::string& path, const DxfFile& file) : path_(path), file_(file) {}

    MeshContent expand() {
        add_entities(file_.entities, {});
        if (!file_.ends) left_out_.add("what may follow the last section: the file has no EOF");
        return {out_.take(), {}, left_out_.list()};
    }

private:
    /// Adds entities. The entities of inserted blocks come last, because Assimp orders them so.
    void add_entities(const std::vector<DxfEntity>& entities, const DxfPlace& place) {
        std::vector<const DxfEntity*> inserts;
        for (std::size_t i = 0; i < entities.size(); ++i) {
            const DxfEntity& entity = entities[i];
            const std::size_t end = end_of(entities, i);
            const std::span vertices(entities.data() + i + 1, end - i - 1);
            i = end - 1;
            if (entity.whole(67, 0, path_) == 1 && place.blocks.empty()) {
                left_out_.add("entities of the paper space");
            } else if (entity.type == "INSERT") {
                inserts.push_back(&entity);
            } else {
                add_entity(entity, vertices, place.transform);
            }
        }
        for (const DxfEntity* insert : inserts) add_insert(*insert, place);
    }

    /// Returns the position after an entity and its vertices.
    static std::size_t end_of(const std::vector<DxfEntity>& entities, std::size_t i) {
        const bool polyline = entities[i].type == "POLYLINE";
        for (++i; polyline && i < entities.size() && entities[i].type == "VERTEX"; ++i) {
        }
        return i;
    }

    void add_entity(const DxfEntity& entity, std::span<const DxfEntity> vertices, const DxfTransform& transform) {
        if (out_.size() > max_bytes)
            refuse(path_, fmt::format("line {}: the inserted blocks are more than 2 GiB", entity.line));
        if (entity.type == "3DFACE") {
            add_face(entity, transform);
        } else if (entity.type == "LINE" || entity.type == "3DLINE") {
            add_line(entity, {entity.point(10, {}, path_), entity.point(11, {}, path_)}, {}, transform);
        } else if (entity.type == "POLYLINE") {
            add_polyline(entity, vertices, transform);
        } else if (has_surfaces(entity.type) || (is_curve(entity.type) && entity.number(39, 0, path_) != 0)) {
            left_out_.add(fmt::format("entities of type {}", entity.type));
        }
    }

    /// Returns whether a type is a curve. A curve with a thickness is a surface.
    static bool is_curve(std::string_view type) { return type == "LWPOLYLINE" || type == "CIRCLE" || type == "ARC"; }

    void add_face(const DxfEntity& entity, const DxfTransform& transform) {
        DxfPoints corners;
        for (int k = 0; k < 4; ++k) {
            if (entity.has(10 + k) || entity.has(20 + k) || entity.has(30 + k))
                corners.push_back(transform * entity.point(10 + k, {}, path_));
        }
        if (corners.size() == 4 && corners[3] == corners[2]) corners.pop_back();
        if (corners.size() > 1) out_.add(entity.text(8), corners);
    }

    /// Adds the edges of a line, or its faces if it has a thickness. `own`: transform from the coordinates of the points to the block's.
    void add_line(const DxfEntity& entity, const DxfPoints& points, const DxfTransform& own,
                  const DxfTransform& transform) {
        const double thickness = entity.number(39, 0, path_);
        const DxfTransform up = DxfTransform::from_entity(entity.point(210, {0, 0, 1}, path_));
        const DxfPoint rise = up * DxfPoint{0, 0, thickness};
        for (std::size_t k = 1; k < points.size(); ++k) {
            const DxfPoint a = own * points[k - 1], b = own * points[k];
            if (thickness == 0) {
                out_.add(entity.text(8), std::array{transform * a, transform * b});
            } else {
                const DxfTransform above = transform * DxfTransform::move(rise);
                out_.add(entity.text(8), std::array{transform * a, transform * b, above * b, above * a});
            }
        }
    }

    void add_polyline(const DxfEntity& entity, std::span<const DxfEntity> vertices, const DxfTransform& transform) {
        const int flags = entity.whole(70, 0, path_);
        if ((flags & polyface) != 0) return add_polyface(entity, vertices, transform);
        DxfPoints points;
        for (const DxfEntity& vertex : vertices) {
            if ((vertex.whole(70, 0, path_) & frame_control) == 0) points.push_back(vertex.point(10, {}, path_));
            if (vertex.number(42, 0, path_) != 0) left_out_.add("arcs of lines, which are read as straight");
        }
        if ((flags & grid) != 0) return add_grid(entity, points, transform);
        if ((flags & closed) != 0 && points.size() > 1) points.push_back(points.front());
        const bool flat = (flags & in_space) == 0;
        add_line(entity, points, flat ? DxfTransform::from_entity(entity.point(210, {0, 0, 1}, path_)) : DxfTransform(),
                 transform);
    }

    void add_polyface(const DxfEntity& entity, std::span<const DxfEntity> vertices, const DxfTransform& transform) {
        DxfPoints points;
        for (const DxfEntity& vertex : vertices) {
            if (!is_face_record(vertex)) points.push_back(transform * vertex.point(10, {}, path_));
        }
        for (const DxfEntity& vertex : vertices) {
            if (!is_face_record(vertex)) continue;
            DxfPoints corners;
            for (int code = 71; code <= 74; ++code) {
                const int index = std::abs(vertex.whole(code, 0, path_));
                if (index == 0) continue;
                if (std::size_t(index) > points.size()) {
                    refuse(path_, fmt::format("line {}: a face refers to vertex {}, but the mesh has {} vertices",
                                              vertex.line, index, points.size()));
                }
                corners.push_back(points[std::size_t(index) - 1]);
            }
            if (corners.size() > 1) out_.add(entity.text(8), corners);
        }
    }

    bool is_face_record(const DxfEntity& vertex) const {
        const int flags = vertex.whole(70, 0, path_);
        return (flags & mesh_vertex) == 0 && ((flags & face_record) != 0 || vertex.has(71));
    }

    /// Adds a mesh of M x N points.
    void add_grid(const DxfEntity& entity, const DxfPoints& points, const DxfTransform& transform) {
        const bool smooth = entity.whole(75, 0, path_) != 0;
        const auto m = std::size_t(std::max(0, entity.whole(smooth ? 73 : 71, 0, path_)));
        const auto n = std::size_t(std::max(0, entity.whole(smooth ? 74 : 72, 0, path_)));
        if (m * n != points.size())
            refuse(path_, fmt::format("line {}: the mesh has {} points in place of {} times {}", entity.line,
                                      points.size(), m, n));
        const int flags = entity.whole(70, 0, path_);
        const std::size_t rows = (flags & closed) != 0 ? m : m - std::min<std::size_t>(m, 1);
        const std::size_t columns = (flags & closed_along_n) != 0 ? n : n - std::min<std::size_t>(n, 1);
        for (std::size_t i = 0; i < rows; ++i) {
            for (std::size_t j = 0; j < columns; ++j) {
                const std::size_t next = (i + 1) % m, beside = (j + 1) % n;
                out_.add(entity.text(8),
                         std::array{transform * points[i * n + j], transform * points[i * n + beside],
                                    transform * points[next * n + beside], transform * points[next * n + j]});
            }
        }
    }

    void add_insert(const DxfEntity& insert, const DxfPlace& place) {
        const std::string_view name = insert.text(2);
        const auto found = file_.blocks.find(name);
        if (found == file_.blocks.end())
            return left_out_.add(fmt::format("inserts of block '{}', which the file does not have", shown(name)));
        if (std::find(place.blocks.begin(), place.blocks.end(), name) != place.blocks.end())
            refuse(path_, fmt::format("line {}: the block '{}' is inserted in itself", insert.line, shown(name)));
        const DxfBlock& block = found->second;
        if ((block.head.whole(70, 0, path_) & 4) != 0) left_out_.add("blocks in other files (external references)");
        const DxfPoint base = block.head.point(10, {}, path_), position = insert.point(10, {}, path_);
        const DxfPoint scale = {insert.number(41, 1, path_), insert.number(42, 1, path_), insert.number(43, 1, path_)};
        const DxfTransform turn = DxfTransform::turn(insert.number(50, 0, path_));
        const DxfTransform outer = place.transform * DxfTransform::from_entity(insert.point(210, {0, 0, 1}, path_)) *
                                   DxfTransform::move(position) * turn;
        const DxfTransform inner = DxfTransform::scale(scale) * DxfTransform::move({-base[0], -base[1], -base[2]});
        DxfPlace next = place;
        next.blocks.push_back(name);
        const int rows = std::max(1, insert.whole(71, 1, path_)), columns = std::max(1, insert.whole(70, 1, path_));
        copies_ += double(rows) * columns;
        if (copies_ > max_copies)
            refuse(path_, fmt::format("line {}: more than {} blocks are inserted", insert.line, max_copies));
        for (int row = 0; row < rows; ++row) {
            for (int column = 0; column < columns; ++column) {
                const DxfPoint step = {column * insert.number(44, 0, path_), row * insert.number(45, 0, path_), 0};
                next.transform = outer * DxfTransform::move(step) * inner;
                add_entities(block.entities, next);
            }
        }
    }

    static constexpr std::size_t max_bytes = std::size_t(1) << 31;
    static constexpr double max_copies = 1e7;

    const std::string& path_;
    const DxfFile& file_;
    DxfWriter out_;
    LeftOut left_out_;
    double copies_ = 0;  // number of copies of blocks so far
};

}  // namespace

MeshContent correct_dxf(const std::string& path, std::string_view bytes) {
    const DxfFile file = DxfFile::parse(path, bytes);
    return DxfExpansion(path, file).expand();
}

}  // namespace octopair::io
