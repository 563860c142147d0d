#include "service/protocol/messages.hpp"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/wire_format_lite.h>
#include <grpcpp/support/proto_buffer_reader.h>

#include <algorithm>
#include <array>
#include <new>
#include <string>

namespace octopair::service {

namespace {

namespace pb = google::protobuf;
using Wire = pb::internal::WireFormatLite;

constexpr std::uint32_t large_tag = Wire::MakeTag(large_field, Wire::WIRETYPE_LENGTH_DELIMITED);

/// Passes the next `length` bytes to `take`, without copying them. Returns false if the input ends before.
bool hand_over(pb::io::CodedInputStream& in, std::uint32_t length, const TakeBytes& take) {
    while (length > 0) {
        const void* data = nullptr;
        int size = 0;
        if (!in.GetDirectBufferPointer(&data, &size) || size <= 0) return false;
        const std::uint32_t taken = std::min(length, std::uint32_t(size));
        take({static_cast<const std::byte*>(data), taken});
        if (!in.Skip(int(taken))) return false;
        length -= taken;
    }
    return true;
}

/// Copies the small fields to `small`, and passes the large field to `take`. Returns false if the message is invalid.
bool split(pb::io::CodedInputStream& in, pb::io::CodedOutputStream& small, const TakeBytes& take) {
    while (const std::uint32_t tag = in.ReadTag()) {
        std::uint32_t length = 0;
        if (tag != large_tag) {
            if (!Wire::SkipField(&in, tag, &small)) return false;
        } else if (!in.ReadVarint32(&length) || !hand_over(in, length, take)) {
            return false;
        }
    }
    return in.ConsumedEntireMessage();
}

}  // namespace

grpc::Slice make_slice(std::size_t bytes) {
    if (bytes == 0) return {};
    return {::operator new(bytes), bytes, [](void* memory) { ::operator delete(memory); }};
}

std::span<std::byte> room_in(const grpc::Slice& slice) {
    return {reinterpret_cast<std::byte*>(const_cast<std::uint8_t*>(slice.begin())), slice.size()};
}

grpc::ByteBuffer pack(const pb::MessageLite& small, const grpc::Slice& large) {
    std::string front;
    {
        pb::io::StringOutputStream bytes(&front);
        pb::io::CodedOutputStream out(&bytes);
        small.SerializeToCodedStream(&out);
        if (large.size() > 0) {
            out.WriteTag(large_tag);
            out.WriteVarint32(std::uint32_t(large.size()));
        }
    }
    const std::array<grpc::Slice, 2> slices = {grpc::Slice(front), large};
    return {slices.data(), large.size() > 0 ? 2u : 1u};
}

bool unpack(grpc::ByteBuffer& message, pb::MessageLite& small, const TakeBytes& take) {
    std::string front;
    {
        grpc::ProtoBufferReader reader(&message);
        if (!reader.status().ok()) return false;
        pb::io::CodedInputStream in(&reader);
        pb::io::StringOutputStream bytes(&front);
        pb::io::CodedOutputStream out(&bytes);
        if (!split(in, out, take)) return false;
    }
    return small.ParseFromString(front);
}

bool unpack(grpc::ByteBuffer& message, pb::MessageLite& small) {
    bool clean = true;
    return unpack(message, small, [&](std::span<const std::byte>) { clean = false; }) && clean;
}

}  // namespace octopair::service
