// Packs and unpacks messages with one large field, without copying this field through protobuf.
//
// The bytes on the wire are valid protobuf: the small fields, then tag, length and bytes of the large field. So clients in any
// language need only the .proto file.
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

/// Field number of the large field, in every message that has one.
inline constexpr int large_field = 15;

/// Maximum size of a message. Client and server refuse larger ones.
inline constexpr std::size_t max_message_bytes = std::size_t(4) << 20;
/// Maximum size of a large field in messages that this program writes.
inline constexpr std::size_t piece_bytes = std::size_t(1) << 20;

/// Returns uninitialised bytes for a large field. Throws: std::bad_alloc (gRPC's own allocation would end the program).
grpc::Slice make_slice(std::size_t bytes);
/// Returns the bytes of a slice of make_slice(), for writing. Requires: the slice has not been passed to pack() yet.
std::span<std::byte> room_in(const grpc::Slice& slice);

/// Receives the large field piece by piece, in order.
using TakeBytes = std::function<void(std::span<const std::byte>)>;

/// Returns a message of the fields of `small` and the large field `large`. An empty `large` omits this field.
grpc::ByteBuffer pack(const google::protobuf::MessageLite& small, const grpc::Slice& large = {});

/// Parses a message into `small`, and passes the bytes of its large field to `take`. Returns false if the message is invalid;
/// `take` may have been called before that was detected.
bool unpack(grpc::ByteBuffer& message, google::protobuf::MessageLite& small, const TakeBytes& take);
/// Parses a message into `small`. Returns false if the message is invalid or has a large field.
bool unpack(grpc::ByteBuffer& message, google::protobuf::MessageLite& small);

}  // namespace octopair::service
