// Messages with one large field: written and read without copying that field through protobuf.
//
// On the wire they are what protobuf writes: the small fields, then the tag and the length of the large one, then its
// bytes. So clients in any language need the .proto alone.
#pragma once

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/slice.h>

#include <cstddef>
#include <functional>
#include <span>

namespace google::protobuf {
class MessageLite;
}  // namespace google::protobuf

namespace octopair::service {

/// The number of the large field in every message that has one.
inline constexpr int large_field = 15;

/// What a message may have; both sides refuse more.
inline constexpr std::size_t most_message_bytes = std::size_t(4) << 20;
/// Of its large field, as this program writes it.
inline constexpr std::size_t piece_bytes = std::size_t(1) << 20;

/// Uninitialised bytes for a large field. Throws std::bad_alloc, where gRPC's own end the program. Until it is handed on,
/// room_in() may be written to.
grpc::Slice make_slice(std::size_t bytes);
std::span<std::byte> room_in(const grpc::Slice& slice);

/// Receives the large field piece by piece, in order.
using TakeBytes = std::function<void(std::span<const std::byte>)>;

/// `large`: of the large field; empty: it is left out.
grpc::ByteBuffer pack(const google::protobuf::MessageLite& small, const grpc::Slice& large = {});

/// Fills `small`, but for the large field, whose bytes go to `take`. False for bytes that are no such message; `take`
/// may have been called nevertheless.
bool unpack(grpc::ByteBuffer& message, google::protobuf::MessageLite& small, const TakeBytes& take);
/// Of a message without a large field.
bool unpack(grpc::ByteBuffer& message, google::protobuf::MessageLite& small);

}  // namespace octopair::service
