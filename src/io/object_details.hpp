// ObjectDetails: details of objects from scene files, besides names, as a table of texts. Equal texts are stored once.
#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace octopair::io {

/// A detail of an object.
enum class Detail : std::uint8_t {
    label,    ///< short name for people
    type,     ///< class of the format, for example IfcBeam
    id,       ///< identifier that stays the same in later versions of the file, for example an IFC GlobalId
    parent,   ///< label of the object or node that contains it
    level,    ///< storey of a building
    material  ///< names of its materials
};
inline constexpr std::array all_details = {Detail::label,  Detail::type,  Detail::id,
                                           Detail::parent, Detail::level, Detail::material};

/// Returns the word for a detail in files, for example "type".
constexpr std::string_view word_of(Detail detail) {
    constexpr std::array<std::string_view, all_details.size()> words = {"label",  "type",  "id",
                                                                        "parent", "level", "material"};
    return words[std::size_t(detail)];
}

/// One text per detail, in the order of all_details. An unknown detail is empty.
using DetailTexts = std::array<std::string, all_details.size()>;

/// Details of n objects, or of no object if no file has details.
struct ObjectDetails {
    std::vector<std::string> words = {{}};                            ///< distinct texts; the first is empty
    std::vector<std::array<std::uint32_t, all_details.size()>> rows;  ///< n rows of indices into `words`

    bool empty() const { return rows.empty(); }
    /// Returns a detail of an object; empty if it is unknown.
    std::string_view of(std::size_t object, Detail detail) const {
        return object < rows.size() ? std::string_view(words[rows[object][std::size_t(detail)]]) : std::string_view();
    }
    /// Returns whether the detail of at least one object is known.
    bool has(Detail detail) const;
};

/// Appends objects to a table.
class DetailsBuilder {
public:
    /// Appends to `table`, which is borrowed.
    explicit DetailsBuilder(ObjectDetails& table);

    void add(const DetailTexts& texts);
    /// Appends `count` objects with the rows of `others`. Objects beyond the last row of `others` get no details.
    void append(const ObjectDetails& others, std::size_t count);

private:
    std::uint32_t number_of(const std::string& word);

    ObjectDetails& table_;
    std::unordered_map<std::string, std::uint32_t> numbers_;  // index of each word
};

/// Returns the names of materials, joined by ", ". If there are more than eight names, "..." stands for the rest.
std::string joined_materials(const std::set<std::string>& names);

/// Counts of objects of two sets.
struct DetailCounts {
    std::size_t first, second;
};
/// Appends the details of a second set to the details of a first set. If a set has no details, its objects get empty rows.
void append_details(ObjectDetails& first, const ObjectDetails& second, const DetailCounts& counts);

}  // namespace octopair::io
