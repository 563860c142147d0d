#include "service/server/calls/job_messages.hpp"

#include <grpcpp/support/byte_buffer.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "octopair/error.hpp"
#include "service/protocol/messages.hpp"
#include "service/protocol/octopair.pb.h"
#include "service/protocol/status.hpp"

namespace octopair::service {

void Upload::take(grpc::ByteBuffer& message) {
    new_bytes_ += message.Length();
    v1::Upload small;
    // The first message may also carry input data, and unpack() passes the data on before the spec is parsed. The target of the data needs
    // the spec, so keep the data until then.
    std::vector<std::byte> held;
    const auto hold = [&](std::span<const std::byte> data) { held.insert(held.end(), data.begin(), data.end()); };
    const auto append = [&](std::span<const std::byte> data) { this->append(data); };
    const bool first = target_ == nullptr;
    if (!unpack(message, small, first ? TakeBytes(hold) : TakeBytes(append))) {
        throw Error(ErrorCode::bad_input, "the message cannot be parsed");
    }
    if (small.has_spec() != first) {
        throw Error(ErrorCode::bad_input,
                    first ? "the first message has no job spec" : "the call has a second job spec");
    }
    if (first) {
        // Unknown fields would take memory and disk space as long as the job exists.
        small.mutable_spec()->DiscardUnknownFields();
        target_ = &begin_(std::move(*small.mutable_spec()));
        missing_ = target_->missing();
        append(held);
    }
}

/// Refuses data after the last byte of the input. By then the job may have ended and freed the target.
void Upload::append(std::span<const std::byte> data) {
    if (data.empty()) return;
    check_fits(data, missing_);
    target_->append(data);
    missing_ -= data.size();
}

bool Upload::take_progress() {
    constexpr std::size_t least = std::size_t(64) << 10;
    if (new_bytes_ < least) return false;
    new_bytes_ = 0;
    return true;
}

void Upload::finish() const {
    if (complete()) return;
    throw Error(ErrorCode::bad_input, target_ == nullptr ? std::string("the call ended before it sent a job spec")
                                                         : "the upload ended " + std::to_string(missing_) +
                                                               " bytes before the job's objects were complete");
}

Download::Next Download::next() {
    try {
        return make_next();
    } catch (...) {
        return {Next::Kind::last, {}, status_of_exception()};
    }
}

Download::Next Download::make_next() {
    using Kind = Next::Kind;
    // Read the report before the pairs: if the state is done, ready() then counts all pairs.
    v1::JobReport report = job_->report();
    if (report.state() == v1::FAILED) return {Kind::last, {}, status_of(report.failure())};
    if (report.state() == v1::CANCELLED) return {Kind::last, {}, status_of(Error(ErrorCode::cancelled, "cancelled"))};
    if (report.state() != v1::RUNNING && report.state() != v1::DONE) return {};

    v1::Download message;
    const std::optional<grpc::Slice> piece = job_->pairs().piece(offset_);
    if (piece) offset_ += piece->size() / sizeof(Pair);
    const bool last = report.state() == v1::DONE && offset_ >= job_->pairs().ready();
    // The client of an attached job received `offset` pairs before its connection broke. The client itself compares this number with
    // the summary, so only detached jobs need this check.
    if (last && job_->detached() && offset_ > job_->pairs().ready()) {
        throw Error(ErrorCode::bad_input, "the result has " + std::to_string(job_->pairs().ready()) +
                                              " pairs; offset " + std::to_string(offset_) + " is beyond its end");
    }
    const bool has_progress = report.progress() >= progress_sent_ + 0.01;
    if (!piece && !last && !has_progress && head_sent_) return {};
    if (!std::exchange(head_sent_, true)) *message.mutable_head() = std::move(*report.mutable_head());
    if (has_progress) message.set_progress(progress_sent_ = report.progress());
    if (last) *message.mutable_summary() = std::move(*report.mutable_summary());
    return {last ? Kind::last : Kind::message, pack(message, piece.value_or(grpc::Slice())), grpc::Status::OK};
}

}  // namespace octopair::service
