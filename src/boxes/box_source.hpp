// BoxSource: the caller's boxes as entries, checked and rounded outward; and the final word on a pair.
//
// Float32 boxes without margin and padding pass through unchanged (`exact()`): overlap of entries is the answer. All
// others are moved to an origin near the bulk, widened by margin / 2 + padding and rounded outward to float32. Each of
// these operations is monotone, or bounded by an error that is added, so a pair that counts is never lost; a hit whose
// boxes overlap by less than the rounding could make is settled by is_pair(), on the caller's own numbers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "boxes/box_kernel.hpp"
#include "boxes/entry.hpp"
#include "boxes/pair_rule.hpp"
#include "octopair/objects.hpp"

namespace octopair {

/// Where entries come from: the caller's boxes, or the entries of a crowded octant (scan.cpp).
class EntrySource {
public:
    virtual ~EntrySource() = default;
    virtual std::size_t size() const = 0;
    /// Writes entries [begin, begin + out.size()); false if one of them is not a valid box.
    virtual bool load(std::size_t begin, std::span<Entry> out) const = 0;
    /// The boxes [begin, begin + count), unchecked, if the entries have their bounds as they are; otherwise empty.
    virtual std::span<const Box3f> plain(std::size_t begin, std::size_t count) const {
        (void)begin, (void)count;
        return {};
    }
    /// Writes the bounds of the entries at `positions`, unchecked.
    virtual void pick(std::span<const std::size_t> positions, std::span<Entry> out) const = 0;
};

/// How boxes become entries: chosen from all objects of a call, also where each process has some of them.
struct EntryForm {
    bool exact = true;         ///< the bounds are taken as they are
    OutwardRounding rounding;  ///< otherwise
};

/// Whether boxes of this set can be taken as they are.
bool is_plain(const Objects& set);

/// The median of some objects' low corners is rounding's origin: near the bulk, whatever a few far objects do.
struct OriginSample {
    using Corner = std::array<double, 3>;
    std::size_t objects;

    std::size_t size() const { return objects < most ? objects : most; }
    std::size_t operator[](std::size_t i) const { return i * objects / size(); }
    /// Corners that are not numbers do not count.
    static std::array<double, 4> median(std::span<const Corner> corners);

private:
    static constexpr std::size_t most = 255;
};

/// The positions of a call's sets, of which a process may have a part: what a message adds to its own.
struct SetBegins {
    std::uint64_t first = 0, second = 0;
};

class BoxSource final : public EntrySource, public PairRule {
public:
    /// `second` may be null (pairs within `first`). Borrows both.
    BoxSource(const Objects& first, const Objects* second, double margin);
    BoxSource(const Objects& first, const Objects* second, const EntryForm& form);

    std::size_t size() const override { return first_size_ + second_size_; }
    bool load(std::size_t begin, std::span<Entry> out) const override;
    std::span<const Box3f> plain(std::size_t begin, std::size_t count) const override;
    void pick(std::span<const std::size_t> positions, std::span<Entry> out) const override;

    bool join() const override { return second_ != nullptr; }
    std::uint32_t second_begin() const override { return join() ? std::uint32_t(first_size_) : 0; }
    bool exact() const override { return form_.exact; }
    RoundingSlack slack() const override;
    /// The rule of objects.hpp, in float64.
    bool is_pair(std::uint32_t a, std::uint32_t b) const override;

    /// How boxes become entries, unless exact().
    const OutwardRounding& rounding() const { return form_.rounding; }
    OriginSample::Corner low_corner(std::size_t position) const;

    /// Throws Error{bad_input} that names the first object from `begin` on which is not a box, and its value.
    [[noreturn]] void refuse(std::size_t begin, const SetBegins& begins = {}) const;

private:
    template <typename Real>
    bool load_set(std::span<const Box<Real>> boxes, std::span<const double> padding, std::size_t begin,
                  std::span<Entry> out) const;
    std::optional<std::string> fault(std::size_t position, const SetBegins& begins) const;
    Box3d box(std::uint32_t object, double& padding) const;

    const Objects* first_;
    const Objects* second_;
    std::size_t first_size_;
    std::size_t second_size_;
    EntryForm form_;
};

}  // namespace octopair
