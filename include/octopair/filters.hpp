// The filters that come with octopair, for a Pipeline (pipeline.hpp).
//
// In a join, the second set's numbers and objects go in `second`; where it is left out, both objects of a pair are of one
// set. Spans are borrowed: they must outlive the filter. Factories throw Error{bad_input} where sizes do not agree.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "octopair/pipeline.hpp"
#include "octopair/pose.hpp"
#include "octopair/shapes.hpp"

namespace octopair {

/// One set's arrays: of each object, the groups that it is in, and those that it collides with.
struct GroupMasks {
    std::span<const std::uint32_t> groups;
    std::span<const std::uint32_t> masks;
};
/// "groups": lets through what wants each other: a's groups are in b's mask and b's in a's.
std::unique_ptr<Filter> make_group_filter(const GroupMasks& first, const std::optional<GroupMasks>& second = {});

/// "ignored pairs": lets through all but these, in any order; of one set, (a, b) is (b, a) as well.
std::unique_ptr<Filter> make_ignored_pairs_filter(std::vector<Pair> ignored, bool join = false);

/// Two patterns: a pair is left out if one name fits one and the other name the other. `*` stands for any characters,
/// `?` for one; an empty name is none, and fits nothing.
struct NameRule {
    std::string a, b;
};
/// "name rules": lets through all that no rule leaves out.
std::unique_ptr<Filter> make_name_filter(std::span<const std::string> names, std::vector<NameRule> rules,
                                         std::optional<std::span<const std::string>> second = {});

/// "same parent": lets through pairs of objects whose numbers (of a parent, a body, a layer) differ.
std::unique_ptr<Filter> make_parent_filter(std::span<const std::uint32_t> parents,
                                           std::optional<std::span<const std::uint32_t>> second = {});

/// Of the exact stages.
struct ExactOptions {
    double margin = 0;  ///< objects count up to this distance (Euclidean), and their paddings; finite, >= 0
    /// Contacts given of each pair, the deepest first; 0: none.
    std::uint32_t max_contacts = 16;
};

/// "bounding spheres", "oriented boxes": leave out what these cheap hulls tell apart by more than margin and paddings.
std::unique_ptr<Filter> make_sphere_filter(const ShapedObjects& first, double margin = 0,
                                           const ShapedObjects* second = nullptr);
std::unique_ptr<Filter> make_oriented_box_filter(const ShapedObjects& first, double margin = 0,
                                                 const ShapedObjects* second = nullptr);

/// "exact object": lets through objects that meet, or are no further apart than margin and paddings allow. Learns the class
/// (`collision`, `contained`, `clearance`), distance and nearest points; of moving objects, the time.
std::unique_ptr<Filter> make_exact_object_filter(const ShapedObjects& first, const ExactOptions& options = {},
                                                 const ShapedObjects* second = nullptr);

/// "exact feature", behind "exact object": learns the class, the depth and the contacts.
std::unique_ptr<Filter> make_exact_feature_filter(const ShapedObjects& first, const ExactOptions& options = {},
                                                  const ShapedObjects* second = nullptr);

/// Triangles as objects. `owners`: empty (one mesh), or of each triangle the mesh that it is of.
struct TriangleSet {
    std::span<const Triangle3d> triangles;
    std::span<const std::uint32_t> owners = {};
};

/// Triangles of one mesh that share corners, by position. `beyond_shared`: count if they meet beyond what they share;
/// `exclude`: do not count; `include`: count.
enum class AdjacentTriangles : std::uint8_t { beyond_shared, exclude, include };

struct TriangleOptions {
    AdjacentTriangles adjacent = AdjacentTriangles::beyond_shared;
    double margin = 0;      ///< triangles that are not adjacent count up to this distance; finite, >= 0
    bool features = false;  ///< learn contact and depth, and whether insides pass through each other or only touch
    unsigned threads = 0;   ///< that check triangles when the filter is made; 0: one per core
};

/// "exact triangle": lets through triangles that meet (closed, no epsilon), or are no further apart than the margin. In a
/// join no two are adjacent.
std::unique_ptr<Filter> make_triangle_filter(const TriangleSet& first, const TriangleOptions& options = {},
                                             const TriangleSet* second = nullptr);

/// Each triangle's box: float32, rounded outward. On so many threads; 0: one per core.
std::vector<Box3f> boxes_of(std::span<const Triangle3d> triangles, unsigned threads = 0);
/// Into the room of as many boxes, such as Engine::allocate_boxes makes.
void boxes_of(std::span<const Triangle3d> triangles, std::span<Box3f> boxes, unsigned threads = 0);

}  // namespace octopair
