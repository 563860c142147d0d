// Answers about the boxes and pairs of one frame, for scenes of files and for live scenes alike.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "viewer/scene/scene_contents.hpp"
#include "viewer/scene/shown_objects.hpp"
#include "viewer/server/answer.hpp"

namespace octopair::viewer {

using Json = nlohmann::ordered_json;

/// Returns JSON as text. Bytes of names that are not UTF-8 are replaced.
Answer json_answer(const Json& json);
Json json_of(const Point3d& point);
Json json_of(const Box3d& box);
/// Returns a number with commas between groups of three digits.
std::string grouped_number(std::uint64_t number);

/// A frame as the page sees it. Borrowed.
struct ShownFrame {
    const SceneContents& contents;
    std::uint64_t objects;  ///< number of objects of the frame
    const ShownObjects& shown;
    const Point3d& origin;
    const FrameData& data;
    std::span<const Pair> began = {}, ended = {};
};

/// Largest numbers of what the page gets at once.
inline constexpr std::size_t max_listed_pairs = 200'000, max_listed_octants = 20'000, max_near = 100'000,
                             max_partners = 1'000, max_found = 50, max_rows = 1'000;

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
/// Returns whether the name of an object has `text` (in lower case), or its index is `text`.
bool matches(const SceneContents& contents, std::uint32_t object, std::string_view text);

/// Returns the objects that are not shown and overlap `region`, the largest first.
Answer near_answer(const ShownFrame& frame, const Box3d& region);
/// Returns the region that the parameters `min` and `max` give. Throws: Error{bad_input}.
Box3d region_of(const Address& address);

}  // namespace octopair::viewer
