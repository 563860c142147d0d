// PendingCalls: encoded calls of a scene (SceneUpload), kept until the step sends them to the server.
//
// Invariants
//   A call with more than `max_objects` objects becomes several records, because records of the protocol are at most 2 MiB.
//   An object has the same index on client and server. The object's generation may be lower on the server, if the client has sent the
//   whole scene again to a new scene of the server.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "scene/recording/recording.hpp"
#include "scene/scene_objects.hpp"

namespace octopair::service {

class PendingCalls final : public CallEncoder {
public:
    /// Sends a piece to the server. The bytes are valid only during the call.
    using Send = std::function<void(Bytes)>;

    void add(const Objects& objects, std::span<const Traits> traits) override;
    void move(RecordKind kind, std::span<const ObjectId> ids, const Boxes& boxes) override;
    void remove(std::span<const ObjectId> ids) override;
    void set_traits(std::span<const ObjectId> ids, std::span<const Traits> traits) override;
    void step() { append(RecordKind::step, {}); }

    /// Sends all pending calls in pieces, then clears them.
    void send(const Send& send);
    void clear() { bytes_.clear(); }

    /// Discards all pending calls, and sends calls that create `objects` in a new scene on the server. Later calls use the ids
    /// of this new scene.
    void send_whole(const SceneOptions& options, const SceneObjects& objects, const Send& send);

private:
    /// Maximum number of objects in one record; an object takes at most 80 bytes.
    static constexpr std::size_t max_objects = 12'000;

    template <typename Encode>
    void encode(std::size_t objects, Encode&& encode_part);
    void append(RecordKind kind, std::initializer_list<Bytes> pieces) override;
    void keep(Bytes bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
    std::span<const ObjectId> server_ids(std::span<const ObjectId> ids);
    void set_generation_offsets(const ObjectTable& table);
    void sweep_again(const SceneObjects& objects, Precision precision);

    std::vector<std::byte> bytes_;
    /// By object index: the client's generation minus the server's. Empty: all 0.
    std::vector<std::uint32_t> generation_offsets_;
    std::vector<ObjectId> ids_;  // buffer of server_ids()
};

}  // namespace octopair::service
