#include "service/client/pending_calls.hpp"

#include <algorithm>

#include "service/protocol/messages.hpp"

namespace octopair::service {

namespace {

Boxes part_of(const Boxes& boxes, std::size_t begin, std::size_t count) {
    return std::visit([&](auto span) -> Boxes { return span.subspan(begin, count); }, boxes);
}

/// Returns the elements for the objects from `begin` on. `all` has one element for each object, a single element for all, or none.
template <typename T>
std::span<const T> part_of(std::span<const T> all, std::size_t begin, std::size_t count) {
    return all.size() > 1 ? all.subspan(begin, count) : all;
}

/// Calls body(begin, count) for consecutive parts of `count` elements, of at most `most` each.
template <typename Body>
void by_parts(std::size_t count, std::size_t most, Body&& body) {
    for (std::size_t begin = 0; begin < count; begin += most) body(begin, std::min(most, count - begin));
}

}  // namespace

/// Encodes a call as one or more records. On an exception, keeps no record of the call.
template <typename Encode>
void PendingCalls::encode(std::size_t objects, Encode&& encode_part) {
    const std::size_t before = bytes_.size();
    try {
        by_parts(objects, max_objects, encode_part);
    } catch (...) {
        bytes_.resize(before);
        throw;
    }
}

void PendingCalls::add(const Objects& objects, std::span<const Traits> traits) {
    encode(std::size_t(objects.size()), [&](std::size_t begin, std::size_t count) {
        CallEncoder::add({part_of(objects.boxes, begin, count), part_of(objects.padding, begin, count)},
                         part_of(traits, begin, count));
    });
}

void PendingCalls::move(RecordKind kind, std::span<const ObjectId> ids, const Boxes& boxes) {
    encode(ids.size(), [&](std::size_t begin, std::size_t count) {
        CallEncoder::move(kind, server_ids(ids.subspan(begin, count)), part_of(boxes, begin, count));
    });
}

void PendingCalls::remove(std::span<const ObjectId> ids) {
    encode(ids.size(),
           [&](std::size_t begin, std::size_t count) { CallEncoder::remove(server_ids(ids.subspan(begin, count))); });
}

void PendingCalls::set_traits(std::span<const ObjectId> ids, std::span<const Traits> traits) {
    encode(ids.size(), [&](std::size_t begin, std::size_t count) {
        CallEncoder::set_traits(server_ids(ids.subspan(begin, count)), part_of(traits, begin, count));
    });
}

void PendingCalls::append(RecordKind kind, std::initializer_list<Bytes> pieces) {
    const auto [head, checksum] = envelope_of(kind, pieces);
    keep(bytes_of(head));
    for (const Bytes piece : pieces) keep(piece);
    keep(bytes_of(checksum));
}

std::span<const ObjectId> PendingCalls::server_ids(std::span<const ObjectId> ids) {
    if (generation_offsets_.empty()) return ids;
    ids_.assign(ids.begin(), ids.end());
    for (ObjectId& id : ids_) {
        if (id.index < generation_offsets_.size()) id.generation -= generation_offsets_[id.index];
    }
    return ids_;
}

void PendingCalls::send(const Send& send) {
    const Bytes all = bytes_;
    by_parts(all.size(), piece_bytes, [&](std::size_t begin, std::size_t count) { send(all.subspan(begin, count)); });
    clear();
}

/// The server's scene must assign the same indices as the client's scene. A new scene assigns ascending indices, and after its first
/// step frees the indices of removed objects in the order of removal. So the calls first add an object for each index of the client's
/// scene. Then they remove the objects at unused indices.
void PendingCalls::send_whole(const SceneOptions& options, const SceneObjects& objects, const Send& send) {
    clear();
    generation_offsets_.clear();
    keep(bytes_of(recording_head(options)));
    const ObjectTable& table = objects.table();
    const Objects all = table.objects();
    by_parts(std::size_t(table.indices()), max_objects, [&](std::size_t begin, std::size_t count) {
        add({part_of(all.boxes, begin, count), part_of(all.padding, begin, count)},
            part_of(table.all_traits(), begin, count));
        if (bytes_.size() >= piece_bytes) this->send(send);
    });
    constexpr std::uint32_t first_generation = 1;
    std::vector<ObjectId> gone;
    for (const auto indices : {table.free(), objects.removed()}) {
        for (const std::uint32_t index : indices) gone.push_back({index, first_generation});
    }
    remove(gone);
    set_generation_offsets(table);
    sweep_again(objects, options.precision);
    this->send(send);
}

void PendingCalls::set_generation_offsets(const ObjectTable& table) {
    bool any = false;
    std::vector<std::uint32_t> older(std::size_t(table.indices()));
    for (std::uint32_t index = 0; index < table.indices(); ++index) {
        older[index] = table.id(index).generation - (table.alive(index) ? 1 : 2);
        any |= older[index] != 0;
    }
    if (any) generation_offsets_ = std::move(older);
}

/// Encodes the sweeps of the current step again. The object table has one box around the whole way of each swept object. The server
/// also needs the box at the end of the way.
void PendingCalls::sweep_again(const SceneObjects& objects, Precision precision) {
    for (const SceneObjects::Swept& swept : objects.swept()) {
        if (!objects.table().contains(swept.id)) continue;
        const Box3d& place = swept.place;
        if (precision == Precision::float64) {
            move(RecordKind::sweep, {&swept.id, 1}, std::span(&place, 1));
            continue;
        }
        Box3f narrow;
        for (int axis = 0; axis < 3; ++axis) {
            narrow.min[axis] = float(place.min[axis]);
            narrow.max[axis] = float(place.max[axis]);
        }
        move(RecordKind::sweep, {&swept.id, 1}, std::span<const Box3f>(&narrow, 1));
    }
}

}  // namespace octopair::service
