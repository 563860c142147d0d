// PendingCalls: calls of a scene as they go to the server (SceneUpload), kept until the step.
//
// No record is long: a call of many objects becomes several. The server's objects may have other generations than the
// client's: its scene may be younger.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "scene/recording/call_encoder.hpp"
#include "scene/scene_objects.hpp"

namespace octopair::service {

class PendingCalls final : public CallEncoder {
public:
    /// Takes a piece; its bytes are valid until it returns.
    using Send = std::function<void(Bytes)>;

    void add(const Objects& objects, std::span<const Traits> traits) override;
    void move(RecordKind kind, std::span<const ObjectId> ids, const Boxes& boxes) override;
    void remove(std::span<const ObjectId> ids) override;
    void set_traits(std::span<const ObjectId> ids, std::span<const Traits> traits) override;
    void step() { append(RecordKind::step, {}); }

    /// Sends all that is kept, in pieces.
    void send(const Send& send);
    void clear() { bytes_.clear(); }

    /// Sends calls that make a new scene on a server what `objects` are; what is kept before is lost. From here on the
    /// server's ids are those of that scene.
    void send_whole(const SceneOptions& options, const SceneObjects& objects, const Send& send);

private:
    /// Of a call that goes in one record: at most 80 bytes each.
    static constexpr std::size_t most_objects = 12'000;

    template <typename Encode>
    void encode(std::size_t objects, Encode&& encode_part);
    void append(RecordKind kind, std::initializer_list<Bytes> pieces) override;
    void keep(Bytes bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
    std::span<const ObjectId> at_server(std::span<const ObjectId> ids);
    void learn_generations(const ObjectTable& table);
    void sweep_again(const SceneObjects& objects, Precision precision);

    std::vector<std::byte> bytes_;
    std::vector<std::uint32_t> older_;  // by how much an object's generation is above the server's; empty: by nothing
    std::vector<ObjectId> ids_;         // of a record
};

}  // namespace octopair::service
