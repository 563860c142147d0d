#include "service/server/jobs/uploaded_input.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "octopair/error.hpp"
#include "service/protocol/job_spec.hpp"
#include "service/protocol/octopair.pb.h"

namespace octopair::service {

UploadedInput::UploadedInput(const v1::JobSpec& spec, std::shared_ptr<Engine> engine, ArrayPool* array_pool)
    : engine_(std::move(engine)), array_pool_(array_pool), joined_(spec.has_second()), hash_(spec) {
    const std::array<const v1::ObjectSet*, 2> sets = {&spec.first(), &spec.second()};
    for (std::size_t i = 0; i < sets.size(); ++i) {
        arrays_[2 * i] = make_room(*sets[i], sets_[i]);
        arrays_[2 * i + 1] = std::as_writable_bytes(std::span(sets_[i].padding));
    }
    missing_ = input_bytes(spec);
}

UploadedInput::~UploadedInput() {
    if (array_pool_ == nullptr) return;
    for (Set& set : sets_) array_pool_->give(*engine_, std::move(set.boxes));
}

std::span<std::byte> UploadedInput::make_room(const v1::ObjectSet& set, Set& made) {
    made.padding.resize(set.padded() ? std::size_t(set.objects()) : 0);
    return set.precision() == v1::FLOAT64 ? make_boxes<double>(set.objects(), made)
                                          : make_boxes<float>(set.objects(), made);
}

template <typename Real>
std::span<std::byte> UploadedInput::make_boxes(std::uint64_t count, Set& made) {
    auto array =
        array_pool_ != nullptr ? array_pool_->take<Real>(*engine_, count) : engine_->allocate_boxes<Box<Real>>(count);
    const std::span<Box<Real>> boxes = array.boxes().first(std::size_t(count));
    made.boxes = std::move(array);
    made.objects = {std::span<const Box<Real>>(boxes), made.padding};
    return std::as_writable_bytes(boxes);
}

void check_fits(std::span<const std::byte> data, std::uint64_t missing) {
    if (data.size() > missing) {
        throw Error(ErrorCode::bad_input, "the upload has more bytes than the job's objects need");
    }
}

void UploadedInput::append(std::span<const std::byte> data) {
    check_fits(data, missing_);
    missing_ -= data.size();
    hash_.add(data);
    while (!data.empty()) {
        std::span<std::byte>& free = arrays_[array_];
        const std::size_t count = std::min(free.size(), data.size());
        if (count > 0) std::memcpy(free.data(), data.data(), count);
        free = free.subspan(count);
        data = data.subspan(count);
        if (free.empty() && array_ + 1 < arrays_.size()) ++array_;
    }
}

}  // namespace octopair::service
