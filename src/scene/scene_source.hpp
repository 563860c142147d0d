// SceneSource: the objects of a scene for a full detection: those alive, and the pairs that their traits allow.
#pragma once

#include <optional>
#include <vector>

#include "boxes/box_source.hpp"
#include "scene/object_table.hpp"

namespace octopair {

/// Each has a bit of the other's groups in its mask, and not both are fixed.
inline bool compatible(const Traits& a, const Traits& b) {
    return (a.mask & b.groups) != 0 && (b.mask & a.groups) != 0 && !(a.fixed && b.fixed);
}

class SceneSource final : public EntrySource, public PairRule {
public:
    /// Borrows the table, which must not change meanwhile.
    SceneSource(const ObjectTable& table, double margin);

    std::size_t size() const override { return std::size_t(table_.size()); }
    bool load(std::size_t begin, std::span<Entry> out) const override;
    std::span<const Box3f> plain(std::size_t begin, std::size_t count) const override;
    void pick(std::span<const std::size_t> positions, std::span<Entry> out) const override;

    bool join() const override { return false; }
    std::uint32_t second_begin() const override { return 0; }
    bool exact() const override { return all_.exact() && !table_.any_traits(); }
    RoundingSlack slack() const override;
    bool is_pair(std::uint32_t a, std::uint32_t b) const override;

    const BoxSource& boxes() const { return all_; }

private:
    /// Indices in use, one after the other.
    struct Run {
        std::size_t position;  ///< of its first
        std::uint32_t index;
    };
    const Run& run_at(std::size_t position) const;
    std::size_t index_at(std::size_t position) const;

    const ObjectTable& table_;
    Objects objects_;
    BoxSource all_;          // by index
    std::vector<Run> runs_;  // by position
};

}  // namespace octopair
