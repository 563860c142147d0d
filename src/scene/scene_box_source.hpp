// SceneBoxSource: presents a scene to the full detection: the objects that are alive, and the pairs that traits allow.
//
// Positions number the objects that are alive, in ascending order of their indices.
#pragma once

#include <optional>
#include <vector>

#include "boxes/box_source.hpp"
#include "scene/object_table.hpp"

namespace octopair {

/// Returns whether objects with these traits may form a pair. Each mask must have a bit of the other object's groups,
/// and at most one of the two objects may be fixed.
inline bool compatible(const Traits& a, const Traits& b) {
    return (a.mask & b.groups) != 0 && (b.mask & a.groups) != 0 && !(a.fixed && b.fixed);
}

class SceneBoxSource final : public EntrySource {
public:
    /// Borrows `table`. Requires: the table does not change while this source exists.
    SceneBoxSource(const ObjectTable& table, double margin);
    SceneBoxSource(const ObjectTable& table, const EntryForm& form);

    std::size_t size() const override { return std::size_t(table_.size()); }
    bool load(std::size_t begin, std::span<Entry> out) const override;
    Float32Boxes float32_boxes(std::size_t begin, std::span<Box3f> room) const override;
    void pick(std::span<const std::size_t> positions, std::span<Entry> out) const override;

    bool join() const override { return false; }
    std::uint32_t second_begin() const override { return 0; }
    bool exact() const override { return all_.exact() && !table_.any_traits(); }
    RoundingSlack slack() const override;
    bool is_pair(std::uint32_t a, std::uint32_t b) const override;
    std::size_t refused(const DoubtfulPairs& doubtful, std::uint32_t* out) const override;
    void load_bounds(std::span<Entry> entries) const override { all_.load_bounds(entries); }

    const BoxSource& boxes() const { return all_; }

private:
    void find_runs();

    /// A run of consecutive indices in use.
    struct Run {
        std::size_t position;  ///< position of its first object
        std::uint32_t index;   ///< index of its first object
    };
    const Run& run_at(std::size_t position) const;
    std::size_t index_at(std::size_t position) const;

    const ObjectTable& table_;
    Objects objects_;
    BoxSource all_;          // all indices, including those not in use
    std::vector<Run> runs_;  // ascending by position
};

}  // namespace octopair
