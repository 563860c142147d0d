// UploadedInput: the objects of a job, put together from the pieces in which they arrive.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "octopair/engine.hpp"
#include "service/protocol/job_hash.hpp"
#include "service/server/jobs/input_target.hpp"
#include "service/server/jobs/array_pool.hpp"

namespace octopair::v1 {
class JobSpec;
class ObjectSet;
}  // namespace octopair::v1

namespace octopair::service {

class UploadedInput final : public InputTarget {
public:
    /// Room for what `spec` says, which was checked; the boxes lie where `engine` reads them, in spare arrays if there are
    /// such, and become spare ones. Throws Error.
    UploadedInput(const v1::JobSpec& spec, Engine& engine, ArrayPool* array_pool = nullptr);
    UploadedInput(const UploadedInput&) = delete;
    UploadedInput& operator=(const UploadedInput&) = delete;
    ~UploadedInput() override;

    void append(std::span<const std::byte> data) override;
    std::uint64_t missing() const override { return missing_; }

    /// Borrows the boxes and paddings.
    Input objects() const { return {sets_[0].objects, joined_ ? std::optional(sets_[1].objects) : std::nullopt}; }
    /// Of a complete input and its options.
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

    Engine& engine_;
    ArrayPool* const spares_;
    std::array<Set, 2> sets_;
    bool joined_;
    JobHash hash_;
    std::array<std::span<std::byte>, 4> arrays_;
    std::size_t array_ = 0;  // that is filled now, and what it lacks is what is left of it
    std::uint64_t missing_ = 0;
};

}  // namespace octopair::service
