#include "scene/recording/recording_reader.hpp"

#include <cstring>
#include <utility>

#include "octopair/error.hpp"

namespace octopair {

namespace {

template <typename T>
std::span<std::byte> bytes_of(T& value) {
    return std::as_writable_bytes(std::span(&value, 1));
}

}  // namespace

/// The unread part of a record's payload.
class RecordingReader::Payload {
public:
    Payload(const RecordingReader& reader, std::uint64_t offset) : reader_(reader), offset_(offset) {
        left_ = reader.payload_.span();
    }

    /// Throws: Error{bad_input} unless exactly `bytes` bytes are left.
    void expect(std::uint64_t bytes) const {
        if (left_.size() == bytes) return;
        refuse("the length of the record does not match its counts: " + std::to_string(left_.size()) +
               " bytes instead of " + std::to_string(bytes));
    }
    std::uint32_t count() {
        if (left_.size() < sizeof(std::uint32_t)) refuse("the record is too short");
        std::uint32_t number = 0;
        copy_to(bytes_of(number));
        return number;
    }
    /// Returns the next `count` elements, copied to `out`. Requires: expect() has checked the length.
    template <typename T>
    std::span<const T> array(std::size_t count, Buffer<T>& out) {
        out.resize_discard(count);
        copy_to(std::as_writable_bytes(out.span()));
        return std::as_const(out).span();
    }
    void copy_to(std::span<std::byte> out) {
        if (!out.empty()) std::memcpy(out.data(), left_.data(), out.size());
        left_ = left_.subspan(out.size());
    }
    [[noreturn]] void refuse(const std::string& what) const { reader_.refuse(offset_, what); }

private:
    const RecordingReader& reader_;
    std::uint64_t offset_;
    Bytes left_;
};

RecordingReader::RecordingReader(RecordingSource source) : source_(std::move(source)) { read_head(); }

void RecordingReader::refuse(std::uint64_t offset, const std::string& what) const {
    throw Error(ErrorCode::bad_input, source_.name + ": byte " + std::to_string(offset) + ": " + what);
}

void RecordingReader::read_head() {
    RecordingHead head;
    if (source_.size < sizeof head) refuse(source_.size, "the file ends before the recording begins");
    source_.read(0, bytes_of(head));
    if (head.magic != RecordingHead::right_magic) refuse(0, "not a recording of a scene");
    if (head.version > RecordingHead::newest_version) {
        refuse(offsetof(RecordingHead, version), "version " + std::to_string(head.version) +
                                                     " is newer than this program, which reads versions up to " +
                                                     std::to_string(RecordingHead::newest_version));
    }
    if (head.checksum != head.right_checksum()) {
        refuse(offsetof(RecordingHead, checksum), "the checksum of the head is wrong");
    }
    if (head.version == 0) refuse(offsetof(RecordingHead, version), "version is 0, but versions start at 1");
    if (head.precision != 32 && head.precision != 64) {
        refuse(offsetof(RecordingHead, precision), "precision is " + std::to_string(head.precision) + ", not 32 or 64");
    }
    options_.precision = head.precision == 64 ? Precision::float64 : Precision::float32;
    options_.margin = head.margin;
    at_ = sizeof head;
}

bool RecordingReader::next(RecordedCall& call) {
    call = {};
    call.offset = at_;
    std::uint64_t left = source_.size - at_;
    cut_ = left > 0 && left < record_overhead;
    if (left < record_overhead) return false;
    RecordHead head{};
    source_.read(at_, bytes_of(head));
    if (head.check != head.right_check()) refuse(at_, "the check of the record's kind and length is wrong");
    left -= record_overhead;
    cut_ = head.length > left;
    if (cut_) return false;
    payload_.resize_discard(std::size_t(head.length));
    std::uint64_t checksum = 0;
    source_.read(at_ + sizeof head, payload_.span());
    source_.read(at_ + sizeof head + head.length, bytes_of(checksum));
    Checksum sum;
    sum.add(bytes_of(head));
    sum.add(payload_.span());
    if (checksum != sum.value()) refuse(at_, "the record's checksum is wrong");
    call.kind = head.kind;
    parse(call);
    at_ += head.length + record_overhead;
    return true;
}

void RecordingReader::parse(RecordedCall& call) {
    Payload payload(*this, call.offset);
    switch (call.kind) {
        case RecordKind::add:
            return parse_objects(payload, call);
        case RecordKind::move:
        case RecordKind::sweep: {
            const std::uint32_t count = payload.count();
            payload.expect(count * (sizeof(ObjectId) + box_bytes()));
            parse_ids(payload, count, call);
            return parse_boxes(payload, count, call);
        }
        case RecordKind::remove: {
            const std::uint32_t count = payload.count();
            payload.expect(count * std::uint64_t(sizeof(ObjectId)));
            return parse_ids(payload, count, call);
        }
        case RecordKind::set_traits: {
            const std::uint32_t count = payload.count(), traits = payload.count();
            payload.expect(count * std::uint64_t(sizeof(ObjectId)) + traits * std::uint64_t(sizeof(RecordedTraits)));
            parse_ids(payload, count, call);
            return parse_traits(payload, traits, call);
        }
        case RecordKind::step:
            return payload.expect(0);
        case RecordKind::result:
            payload.expect(sizeof call.result);
            return payload.copy_to(bytes_of(call.result));
    }
    refuse(call.offset, "unknown kind of record: " + std::to_string(std::uint32_t(call.kind)));
}

void RecordingReader::parse_objects(Payload& payload, RecordedCall& call) {
    const std::uint32_t count = payload.count(), paddings = payload.count(), traits = payload.count();
    payload.expect(count * box_bytes() + paddings * std::uint64_t(sizeof(double)) +
                   traits * std::uint64_t(sizeof(RecordedTraits)));
    parse_boxes(payload, count, call);
    call.objects.padding = payload.array(paddings, paddings_);
    parse_traits(payload, traits, call);
}

void RecordingReader::parse_boxes(Payload& payload, std::uint32_t count, RecordedCall& call) {
    if (options_.precision == Precision::float64) {
        call.objects.boxes = payload.array(count, boxes64_);
    } else {
        call.objects.boxes = payload.array(count, boxes32_);
    }
}

void RecordingReader::parse_ids(Payload& payload, std::uint32_t count, RecordedCall& call) {
    call.ids = payload.array(count, ids_);
}

void RecordingReader::parse_traits(Payload& payload, std::uint32_t count, RecordedCall& call) {
    traits_.clear();
    for (const RecordedTraits& one : payload.array(count, packed_)) {
        if (one.fixed > 1) payload.refuse("the trait `fixed` is " + std::to_string(one.fixed) + ", not 0 or 1");
        traits_.push_back({one.groups, one.mask, one.fixed != 0});
    }
    call.traits = traits_;
}

std::uint64_t RecordingReader::box_bytes() const {
    return options_.precision == Precision::float64 ? sizeof(Box3d) : sizeof(Box3f);
}

}  // namespace octopair
