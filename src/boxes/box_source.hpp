// BoxSource: converts the caller's boxes to entries, checked and rounded outward, and decides close hits exactly.
//
// Invariants
//   Float32 boxes without margin and padding are copied unchanged (`exact()`): two objects are a pair if their entries overlap.
//   All other boxes are moved to an origin near the bulk, widened by margin / 2 + padding, and rounded outward to float32.
//   Each of these operations is monotone, or has a bounded error that is added. So no pair is lost.
//   If boxes overlap by no more than rounding could cause, is_pair() decides with the caller's own numbers.
//   The caller's numbers may change during a call, such as those of a mapped file. Then the result is arbitrary, but no memory is damaged.
//   A number that decides the size of an array is read only once. Code that reads a number again accepts any value, also NaN.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/private_export.hpp"
#include "boxes/entry.hpp"
#include "boxes/entry_source.hpp"
#include "boxes/invalid_box.hpp"
#include "boxes/origin_sample.hpp"
#include "boxes/outward_rounding.hpp"
#include "octopair/objects.hpp"

namespace octopair {

/// Conversion of boxes to entries. It depends on all objects of a call, even if each process has only some of them.
struct EntryForm {
    bool exact = true;         ///< bounds are copied unchanged
    OutwardRounding rounding;  ///< used if not `exact`
};

class OCTOPAIR_PRIVATE_EXPORT BoxSource final : public EntrySource {
public:
    /// Borrows both sets. If `second` is null, pairs are those within `first`.
    BoxSource(const Objects& first, const Objects* second, double margin);
    BoxSource(const Objects& first, const Objects* second, const EntryForm& form);

    std::size_t size() const override { return first_size_ + second_size_; }
    bool load(std::size_t begin, std::span<Entry> out) const override;
    Float32Boxes float32_boxes(std::size_t begin, std::span<Box3f> room) const override;
    void pick(std::span<const std::size_t> positions, std::span<Entry> out) const override;

    bool join() const override { return second_ != nullptr; }
    std::uint32_t second_begin() const override { return join() ? std::uint32_t(first_size_) : 0; }
    bool exact() const override { return form_.exact; }
    RoundingSlack slack() const override;
    /// Evaluates the pair rule of octopair/objects.hpp in float64.
    bool is_pair(std::uint32_t a, std::uint32_t b) const override;
    std::uint32_t pairs_with(const std::uint32_t* objects, std::uint32_t other, std::uint32_t asked) const override;
    std::size_t refused(const DoubtfulPairs& doubtful, std::uint32_t* out) const override;
    void load_bounds(std::span<Entry> entries) const override;

    /// Returns the conversion of boxes to entries, used unless exact().
    const OutwardRounding& rounding() const { return form_.rounding; }
    OriginSample::Corner low_corner(std::size_t position) const;

    /// Throws: Error{bad_input} with the first object from `begin` on that is not a valid box, and the wrong value.
    [[noreturn]] void refuse(std::size_t begin, const SetBegins& begins = {}) const;

private:
    template <typename Real>
    bool load_set(std::span<const Box<Real>> boxes, std::span<const double> padding, std::size_t begin,
                  std::span<Entry> out) const;
    Box3d box(std::uint32_t object, double& padding) const;

    const Objects* first_;
    const Objects* second_;
    std::size_t first_size_;
    std::size_t second_size_;
    EntryForm form_;
    // Boxes of the sets if all are float64 without padding; otherwise null. pairs_with() reads these boxes in place.
    const Box3d* plain_wide_first_ = nullptr;
    const Box3d* plain_wide_second_ = nullptr;
};

}  // namespace octopair
