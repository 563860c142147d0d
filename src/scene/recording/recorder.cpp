#include "scene/recording/recorder.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <exception>

#include "base/descriptor.hpp"
#include "octopair/error.hpp"

namespace octopair {

namespace {

constexpr std::size_t buffer_bytes = std::size_t(256) << 10;

}  // namespace

Recorder::Recorder(const SceneOptions& options) : path_(options.recording), buffer_(buffer_bytes) {
    // O_NONBLOCK: opening a pipe without a reader fails instead of waiting. It has no effect on a regular file.
    descriptor_ = Descriptor(::open(path_.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC | O_NONBLOCK, 0666));
    if (!descriptor_.open()) fail_io(path_, "cannot create", errno);
    keep(bytes_of(recording_head(options)));
    flush();
}

Recorder::~Recorder() {
    try {
        flush();
    } catch (const std::exception&) {
        // A destructor cannot report the error. The records already in the file are complete.
    }
}

void Recorder::begin_step() {
    append(RecordKind::step, {});
    try {
        flush();
    } catch (...) {
        used_ -= record_overhead;  // removes the record of this step, which fails
        throw;
    }
}

void Recorder::end_step(const StepResult& result) noexcept {
    try {
        const RecordedResult recorded = recorded_result(result);
        append(RecordKind::result, {bytes_of(recorded)});  // fits: begin_step() has emptied the buffer
        flush();
    } catch (const std::exception&) {
        // The record stays in the buffer. The next call tries to write it again, and reports the error.
    }
}

void Recorder::append(RecordKind kind, std::initializer_list<Bytes> pieces) {
    const auto [head, checksum] = envelope_of(kind, pieces);
    if (head.length + record_overhead > buffer_.size() - used_) flush();
    if (head.length + record_overhead > buffer_.size()) return write_large(pieces, head, checksum);
    keep(bytes_of(head));
    for (const Bytes piece : pieces) keep(piece);
    keep(bytes_of(checksum));
}

void Recorder::keep(Bytes bytes) {
    if (!bytes.empty()) std::memcpy(buffer_.data() + used_, bytes.data(), bytes.size());
    used_ += bytes.size();
}

void Recorder::flush() {
    if (used_ == 0) return;
    write_at(end_, buffer_.span().first(used_));
    end_ += used_;
    used_ = 0;
}

void Recorder::write_large(std::initializer_list<Bytes> pieces, const RecordHead& head, std::uint64_t checksum) {
    std::uint64_t at = end_;
    const auto write_next = [&](Bytes bytes) {
        write_at(at, bytes);
        at += bytes.size();
    };
    write_next(bytes_of(head));
    for (const Bytes piece : pieces) write_next(piece);
    write_next(bytes_of(checksum));
    end_ = at;
}

void Recorder::write_at(std::uint64_t offset, Bytes bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::pwrite(descriptor_.number(), bytes.data(), bytes.size(), off_t(offset));
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) {
            const int error = errno;
            // Remove the incomplete record, so that no bytes of it remain behind a shorter record at its place.
            (void)!::ftruncate(descriptor_.number(), off_t(end_));
            fail_io(path_, "cannot write", error);
        }
        offset += std::uint64_t(written);
        bytes = bytes.subspan(std::size_t(written));
    }
}

}  // namespace octopair
