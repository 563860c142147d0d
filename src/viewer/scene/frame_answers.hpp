// Functions that make the answers to a page's requests about one frame. Scenes of files and live scenes use the same functions.
#pragma once

#include <compare>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "octopair/octants.hpp"
#include "viewer/scene/answer.hpp"
#include "viewer/scene/scene_contents.hpp"
#include "viewer/scene/shown_objects.hpp"

namespace octopair::viewer {

using Json = nlohmann::ordered_json;

/// Returns JSON as text. Bytes of names that are not UTF-8 are replaced.
Answer json_answer(const Json& json);
Json json_of(const Point3d& point);
Json json_of(const Box3d& box);
/// Returns a number with commas between groups of three digits.
std::string grouped_number(std::uint64_t number);

/// A frame as the page shows it. Borrows all members.
struct ShownFrame {
    const SceneContents& contents;
    std::uint64_t objects;  ///< number of objects of the frame
    const ShownObjects& shown;
    const Point3d& origin;
    const FrameData& data;
    std::span<const Pair> began = {}, ended = {};
};

/// Maximum numbers of pairs, octants and other elements in one answer.
inline constexpr std::size_t max_listed_pairs = 200'000, max_listed_octants = 20'000, max_near = 100'000,
                             max_partners = 1'000, max_found = 50, max_rows = 200'000;
/// An answer with more rows than this is brief: names of shown objects are left out, and later rows have only their first contact.
inline constexpr std::size_t max_full_rows = 1'000;

/// Returns the boxes of all rows.
Answer box_rows(const ShownFrame& frame);
/// Returns the number of pairs of each row's object.
Answer partner_counts(const ShownFrame& frame);
/// Returns the number of pairs of each object.
std::vector<std::uint32_t> pair_counts(const FrameData& data, std::uint64_t objects);
/// Returns the first pairs, at most `most`.
Answer pair_rows(std::span<const Pair> pairs, std::size_t most = max_listed_pairs);

/// Returns the name of an object; empty if it has none.
std::string_view name_of(const SceneContents& contents, std::uint32_t object);
/// Returns a text in lower case, as far as it is ASCII.
std::string lower_case(std::string_view text);
/// Searches the names and the details of objects for a text.
class TextSearch {
public:
    /// `text` is in lower case. Borrows the contents.
    TextSearch(const SceneContents& contents, std::string_view text);

    /// Returns whether the name or a detail of an object has the text, or its index is the text.
    bool finds(std::uint32_t object) const;

private:
    const SceneContents& contents_;
    std::string text_;
    std::vector<bool> found_;  // for each word of the details, whether it has the text
};

/// Returns the objects that are not shown and overlap `region`, the largest first.
Answer near_answer(const ShownFrame& frame, const Box3d& region);
/// Returns the region that the parameters `min` and `max` give. Throws: Error{bad_input}.
Box3d region_of(const Address& address);

// object_answers.cpp

/// Returns what is known about an object; nothing if there is no such object. `octants` may be null.
std::optional<Answer> object_answer(const ShownFrame& frame, std::uint32_t object, const Octants* octants);
/// Returns the objects whose name or index has `text`, the best first.
Answer search_answer(const ShownFrame& frame, std::string_view text);

// collision_table.cpp

/// Returns the word for a class, for example "penetrating".
std::string_view class_word(CollisionClass collision_class);

/// Orders collisions from the least to the worst one: first by class, then by depth or distance.
struct Severity {
    std::uint8_t rank;
    double depth;

    auto operator<=>(const Severity&) const = default;
};
/// Returns how bad a collision is. `overlap`: its depth if the finding has none.
Severity severity_of(const Finding& finding, double overlap = 0);

/// Selects rows of the table of collisions.
struct RowRequest {
    std::uint64_t from = 0, count = 100;
    enum class Sort : std::uint8_t {
        pair,
        worst,  ///< by class, penetrating first, and in a class deepest first; boxes without depths by their overlap
        began
    } sort = Sort::pair;
    std::optional<std::uint32_t> object, with;  ///< only pairs with this object, or with both
    std::string text;
};
/// Returns the selection that the parameters give. Throws: Error{bad_input} for an invalid parameter.
RowRequest row_request(const Address& address);
/// Returns the class of the worst pair of each row's object; 255 for objects without pairs.
Answer class_rows(const ShownFrame& frame);
/// Returns the selected rows, and the number of all rows that match.
Answer collision_rows(const ShownFrame& frame, const RowRequest& request);
/// Returns the rows of collisions that are gone.
Answer gone_rows(std::span<const GoneCollision> gone);

// octant_answers.cpp

/// Returns the numbers of octants, leaves and listed octants of each level.
Answer octant_summary(const Octants& octants);
/// Returns the first octants of a level, relative to `origin`.
Answer octant_level(const Octants& octants, unsigned level, const Point3d& origin);
/// Returns the octants of an octree of the boxes that exist in the frame, on `threads` threads; 0: one per core.
Octants octants_of(const ShownFrame& frame, unsigned threads = 0);
/// Returns for each object the level of the octant in which its box begins; 0 for objects that do not exist.
std::vector<std::uint8_t> levels_of(const FrameData& data, const Octants& octants);
/// Returns the code of the octant in which an object's box begins. Requires: the object exists in the frame.
OctalCode home_code(const FrameData& data, std::uint32_t object, const Octants& octants);

}  // namespace octopair::viewer
