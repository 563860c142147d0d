// UploadedInput: the objects of a job, assembled from the pieces in which they arrive.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "octopair/engine.hpp"
#include "service/protocol/job_hash.hpp"
#include "service/server/jobs/array_pool.hpp"

namespace octopair::v1 {
class JobSpec;
class ObjectSet;
}  // namespace octopair::v1

namespace octopair::service {

/// Receives the input of a job, piece by piece.
class InputTarget {
public:
    virtual ~InputTarget() = default;
    /// Throws: Error{bad_input} if `data` is longer than missing().
    virtual void append(std::span<const std::byte> data) = 0;
    /// Returns the number of bytes that were not appended yet.
    virtual std::uint64_t missing() const = 0;
};

/// Throws: Error{bad_input} if `data` has more than `missing` bytes.
void check_fits(std::span<const std::byte> data, std::uint64_t missing);

class UploadedInput final : public InputTarget {
public:
    /// Allocates the arrays that `spec` describes, in memory of `engine`. If `array_pool` is given, box arrays come from this pool, and the
    /// destructor returns them. Requires: check(spec) has passed. Throws: Error.
    UploadedInput(const v1::JobSpec& spec, std::shared_ptr<Engine> engine, ArrayPool* array_pool = nullptr);
    UploadedInput(const UploadedInput&) = delete;
    UploadedInput& operator=(const UploadedInput&) = delete;
    ~UploadedInput() override;

    void append(std::span<const std::byte> data) override;
    std::uint64_t missing() const override { return missing_; }

    /// Returns the objects of both sets. The spans point into this object.
    Input objects() const { return {sets_[0].objects, joined_ ? std::optional(sets_[1].objects) : std::nullopt}; }
    /// Returns the hash of input and options. Requires: the input is complete.
    std::string hash() const { return hash_.digest(); }

private:
    struct Set {
        AnyBoxes boxes;
        std::vector<double> padding;
        Objects objects;
    };

    std::span<std::byte> make_room(const v1::ObjectSet& set, Set& made);
    template <typename Real>
    std::span<std::byte> make_boxes(std::uint64_t count, Set& made);

    const std::shared_ptr<Engine> engine_;
    ArrayPool* const array_pool_;
    std::array<Set, 2> sets_;
    bool joined_;
    JobHash hash_;
    std::array<std::span<std::byte>, 4> arrays_;  // unfilled parts of the arrays: boxes and paddings of both sets
    std::size_t array_ = 0;      // index of the array being filled; arrays_[array_] is its unfilled part
    std::uint64_t missing_ = 0;  // bytes of the input that were not appended yet
};

}  // namespace octopair::service
