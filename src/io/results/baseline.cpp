#include "io/results/baseline.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/memory.hpp"
#include "io/files/failure.hpp"
#include "io/files/input_file.hpp"
#include "io/formats/format_choice.hpp"
#include "io/json/json_fields.hpp"
#include "io/json/json_text.hpp"
#include "io/results/collision_columns.hpp"
#include "io/results/collision_key.hpp"

namespace octopair::io {

namespace {

/// Identity of an object across results.
struct ObjectId {
    std::uint32_t number;
    std::string name;
    std::optional<std::uint32_t> triangle;

    /// Returns the identity as text. `set` is put before the number of an object without a name.
    std::string text(std::string_view set) const {
        if (name.empty()) return fmt::format("{}#{}", set, number);
        return triangle ? fmt::format("{}/{}", *triangle, name) : "/" + name;
    }
};

// First character of a key, the contact state of the two objects: unknown, apart, or in contact.
constexpr char state_unknown = '?', state_apart = '-', state_in_contact = '+';

char contact_state(const CollisionRecord& row) {
    if (row.collision_class.value_or(CollisionClass::unknown) == CollisionClass::unknown) return state_unknown;
    return meet(*row.collision_class) ? state_in_contact : state_apart;
}

/// Returns the contact states that match a collision of this class, the best match first.
std::string_view matching_states(CollisionClass collision_class) {
    if (collision_class == CollisionClass::unknown) return "?+-";
    return meet(collision_class) ? "+?" : "-?";
}

/// Returns the key of a collision for a comparison by names.
std::string key_of_names(const ObjectId& a, const ObjectId& b, bool join) {
    std::string first = a.text(join ? "a" : ""), second = b.text(join ? "b" : "");
    if (second < first) std::swap(first, second);
    return fmt::format("{}{}:{}{}", state_unknown, first.size(), first, second);
}

/// Returns a key with room for the state. No key of names has the second character.
std::string with_state(const std::string& key) { return fmt::format("{}={}", state_unknown, key); }

ObjectId id_of(const RecordedObject& object) { return {object.number, std::string(object.name), object.triangle}; }

ObjectId id_of(std::uint32_t object, const ObjectNames& names) {
    ObjectId id{object, clean_text(names.of(object)), {}};
    if (!names.owners.empty()) id.triangle = names.triangle(object);
    return id;
}

}  // namespace

Baseline::Baseline(const std::string& path, bool join, const std::stop_token& stop) : join_(join) {
    check_not_wrapped(path);
    const InputFile file(path);
    Buffer<char> text{std::size_t(file.size())};
    file.read(0, std::as_writable_bytes(text.span()), stop);
    read({text.data(), text.size()}, path, stop);
}

Baseline Baseline::of_text(std::string_view text, std::string_view file, bool join) {
    Baseline baseline(join);
    baseline.read(text, file, {});
    return baseline;
}

void Baseline::read(std::string_view text, std::string_view file, const std::stop_token& stop) {
    for (std::uint64_t number = 1; !text.empty(); ++number) {
        if (stop.stop_requested()) cancel();
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        if (line.ends_with('\r')) line.remove_suffix(1);
        if (line.find_first_not_of(" \t") == std::string_view::npos) continue;
        const std::string place = fmt::format("{}: line {}", file, number);
        const nlohmann::json value = parse_json(line, place, stop);
        const JsonFields row(value, place);
        if (row.find("frame") != nullptr) row.refuse_key("frame", "results of moving scenes cannot be compared");
        const CollisionRecord collision = read_collision(row);
        // The file may be the result of an earlier comparison. Its "gone" rows are not part of that result.
        if (collision.change == Change::gone) continue;
        by_name_ |= collision.key.empty();
        std::string key = collision.key.empty() ? key_of_names(id_of(collision.a), id_of(collision.b), join_)
                                                : with_state(collision.key);
        key[0] = contact_state(collision);
        unmatched_[key].push_back(lines_.size());
        lines_.emplace_back(line);
    }
    matched_.resize(lines_.size());
    counts_.gone = lines_.size();
    for (auto& [key, rows] : unmatched_) std::reverse(rows.begin(), rows.end());
}

bool Baseline::match(std::string key, CollisionClass collision_class) {
    for (const char state : matching_states(collision_class)) {
        key[0] = state;
        const auto rows = unmatched_.find(key);
        if (rows == unmatched_.end() || rows->second.empty()) continue;
        matched_[rows->second.back()] = true;
        rows->second.pop_back();
        return true;
    }
    return false;
}

std::vector<Change> Baseline::compare(std::span<const Pair> pairs, std::span<const Finding> findings,
                                      const CollisionNames& names) {
    std::vector<Change> changes(pairs.size(), Change::begun);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const CollisionClass now = findings.empty() ? CollisionClass::unknown : findings[i].collision_class;
        const Pair pair = pairs[i];
        const bool known =
            match(with_state(collision_key(pair, names)), now) ||
            (by_name_ && match(key_of_names(id_of(pair.a, names.a), id_of(pair.b, names.b), join_), now));
        if (known) changes[i] = Change::same;
    }
    const auto same = std::uint64_t(std::count(changes.begin(), changes.end(), Change::same));
    counts_.same += same;
    counts_.gone -= same;
    counts_.begun += changes.size() - same;
    return changes;
}

std::vector<std::string_view> Baseline::gone() const {
    std::vector<std::string_view> gone;
    for (std::size_t i = 0; i < lines_.size(); ++i) {
        if (!matched_[i]) gone.emplace_back(lines_[i]);
    }
    return gone;
}

ChangeCounts Baseline::counts() const { return counts_; }

}  // namespace octopair::io
