// The filters that octopair provides for a Pipeline (pipeline.hpp).
//
// Joins     The arguments `first` and `second` describe the first and the second set of a join. Without `second`, both
//           objects of a pair are in one set.
// Ownership Spans are borrowed: the arrays must outlive the filter.
// Errors    The functions throw Error{bad_input} if sizes differ.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "octopair/pipeline.hpp"
#include "octopair/pose.hpp"
#include "octopair/shapes.hpp"

namespace [[gnu::visibility("default")]] octopair {

/// Group bits of one set of objects. Both arrays have one element per object.
struct GroupMasks {
    std::span<const std::uint32_t> groups;  ///< groups that the object belongs to
    std::span<const std::uint32_t> masks;   ///< groups that the object collides with
};
/// Returns the filter "groups". Keeps pairs where b's mask has a bit of a's groups, and a's mask has a bit of b's groups.
std::unique_ptr<Filter> make_group_filter(const GroupMasks& first, const std::optional<GroupMasks>& second = {});

/// Returns the filter "ignored pairs", which drops the pairs in `ignored`. Their order does not matter. Without a join,
/// (a, b) also drops (b, a).
std::unique_ptr<Filter> make_ignored_pairs_filter(std::vector<Pair> ignored, bool join = false);

/// Two name patterns. The rule drops a pair if one object's name matches `a` and the other object's name matches `b`.
/// `*` matches any characters, `?` matches one character. An empty name means no name and matches no pattern.
struct NameRule {
    std::string a, b;
};
/// Returns the filter "name rules", which drops each pair that at least one rule drops.
std::unique_ptr<Filter> make_name_filter(std::span<const std::string> names, std::vector<NameRule> rules,
                                         std::optional<std::span<const std::string>> second = {});

/// Texts of one set of objects in columns, for example a column of names and a column of types. Borrowed.
struct TextColumns {
    std::size_t objects = 0;
    /// Returns the text of an object in a column; empty: the object has none.
    std::function<std::string_view(std::uint32_t object, std::size_t column)> text;
};
/// A pattern per column. An object matches if, in each column with a pattern, its text matches the pattern. The list may end before the
/// last column: columns without an element have no pattern.
using ColumnPatterns = std::vector<std::optional<std::string>>;
/// The rule drops a pair if one object matches `a` and the other object matches `b`. Patterns are those of NameRule.
struct ColumnRule {
    ColumnPatterns a, b;
};
/// Returns the filter "name rules" for several columns. `text` is called only by this function.
std::unique_ptr<Filter> make_column_filter(const TextColumns& first, const std::vector<ColumnRule>& rules,
                                           const TextColumns* second = nullptr);

/// Returns the filter "same parent", which keeps pairs of objects with different parent numbers. A parent is any number that
/// the caller assigns, such as a body or a layer.
std::unique_ptr<Filter> make_parent_filter(std::span<const std::uint32_t> parents,
                                           std::optional<std::span<const std::uint32_t>> second = {});

/// Options of the exact filters.
struct ExactOptions {
    double margin = 0;  ///< largest Euclidean distance, besides paddings, at which a pair is kept; finite, >= 0
    /// Maximum number of contacts stored per pair, which also bounds memory; 0: none. If a pair has more, the deepest are kept, and
    /// Finding::more_contacts is true. Of equally deep contacts, those of the triangles with the lowest indices are kept.
    std::uint32_t max_contacts = 16;
    /// Length, finite, >= 0. Objects are `touching` if a translation of at most this length is proven to separate them, up to
    /// rounding errors; closed meshes also if their overlap is proven to be at most this thick, and to open (docs/design.md).
    double tolerance = 0;
    /// Length, finite, >= 0; the default is the tolerance. Objects of the same geometry are `duplicate` if each corner of one object is at
    /// most this far from the same corner of the other object.
    std::optional<double> duplicate_tolerance = {};
    /// "exact object" keeps pairs as `undecided` that it would drop: an object lies in the bounds of a mesh that is not closed, and may be
    /// inside it. Objects that move are not kept.
    bool keep_undecided = false;
};

/// Returns the filter "bounding spheres". Drops pairs whose bounding spheres are further apart than margin and paddings.
std::unique_ptr<Filter> make_sphere_filter(const ShapedObjects& first, double margin = 0,
                                           const ShapedObjects* second = nullptr);
/// Returns the filter "oriented boxes". Drops pairs whose oriented boxes are further apart than margin and paddings.
std::unique_ptr<Filter> make_oriented_box_filter(const ShapedObjects& first, double margin = 0,
                                                 const ShapedObjects* second = nullptr);

/// Returns the filter "exact object". Keeps objects that meet, or whose distance is at most margin and paddings. Computes the
/// class (`collision`, `contained`, `clearance`), the distance and the nearest points; for moving objects, the time of impact.
std::unique_ptr<Filter> make_exact_object_filter(const ShapedObjects& first, const ExactOptions& options = {},
                                                 const ShapedObjects* second = nullptr);

/// Returns the filter "exact feature", which computes the class, the depth and the contacts of a pair.
/// Requires: "exact object" is before it in the pipeline.
std::unique_ptr<Filter> make_exact_feature_filter(const ShapedObjects& first, const ExactOptions& options = {},
                                                  const ShapedObjects* second = nullptr);

/// Returns the filter "depth", which drops pairs that are certainly less deep than `min_depth`: Finding::depth_at_most is smaller, or the
/// overlap of a touching pair is proven to be thinner.
/// Keeps pairs without a depth. Requires: "exact feature" or "exact triangle" is before it.
std::unique_ptr<Filter> make_depth_filter(double min_depth);

/// Triangles as objects.
struct TriangleSet {
    std::span<const Triangle3d> triangles;
    std::span<const std::uint32_t> owners = {};  ///< mesh number of each triangle; empty: all are of one mesh
};

/// Treatment of adjacent triangles: triangles of one mesh that share corners (equal positions).
enum class AdjacentTriangles : std::uint8_t {
    beyond_shared,  ///< keeps the pair if the triangles also meet outside of the shared corners and edges
    exclude,        ///< drops the pair
    include         ///< keeps the pair
};

struct TriangleOptions {
    AdjacentTriangles adjacent = AdjacentTriangles::beyond_shared;
    double margin = 0;      ///< largest distance at which triangles that are not adjacent are kept; finite, >= 0
    bool features = false;  ///< true: computes contact and depth, and distinguishes penetrating from touching
    /// With `features`: length, finite, >= 0. Triangles count as touching if a translation of at most this length separates them.
    double tolerance = 0;
    unsigned threads = 0;  ///< threads that check the triangles when the filter is made; 0: one per core
};

/// Returns the filter "exact triangle". Keeps triangles that meet (closed sets, no epsilon), or whose distance is at most the
/// margin. In a join no triangles are adjacent.
std::unique_ptr<Filter> make_triangle_filter(const TriangleSet& first, const TriangleOptions& options = {},
                                             const TriangleSet* second = nullptr);

/// Returns the box of each triangle in float32, rounded outward. Uses `threads` threads; 0: one per core.
std::vector<Box3f> boxes_of(std::span<const Triangle3d> triangles, unsigned threads = 0);
/// Like the function above, but writes the boxes to `boxes`, for example memory from Engine::allocate_boxes.
/// Requires: `boxes` has as many elements as `triangles`.
void boxes_of(std::span<const Triangle3d> triangles, std::span<Box3f> boxes, unsigned threads = 0);

}  // namespace octopair
