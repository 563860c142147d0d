#include "io/baseline.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "base/memory.hpp"
#include "io/failure.hpp"
#include "io/input_file.hpp"
#include "io/json_fields.hpp"
#include "io/json_text.hpp"

namespace octopair::io {

namespace {

/// What an object is known by.
struct ObjectId {
    std::uint32_t number;
    std::string name;
    std::optional<std::uint32_t> triangle;

    /// `set`: of those without a name.
    std::string text(std::string_view set) const {
        if (name.empty()) return fmt::format("{}#{}", set, number);
        return triangle ? fmt::format("{}/{}", *triangle, name) : "/" + name;
    }
};

std::string key_of_ids(const ObjectId& a, const ObjectId& b, bool join) {
    std::string first = a.text(join ? "a" : ""), second = b.text(join ? "b" : "");
    if (second < first) std::swap(first, second);
    return fmt::format("{}:{}{}", first.size(), first, second);
}

ObjectId id_in(const JsonFields& row, const std::string& side) {
    ObjectId id;
    id.number = row.whole_number(side);
    if (row.find(side + "_name") != nullptr) id.name = row.text(side + "_name");
    if (row.find(side + "_triangle") != nullptr) id.triangle = row.whole_number(side + "_triangle");
    return id;
}

ObjectId id_of(std::uint32_t object, const ObjectNames& names) {
    ObjectId id{object, clean_text(names.of(object)), {}};
    if (!names.owners.empty()) id.triangle = names.triangle(object);
    return id;
}

}  // namespace

Baseline::Baseline(const std::string& path, bool join, const std::stop_token& stop) : join_(join) {
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
        // Rows of a comparison that was itself written to a file.
        if (row.find("change") != nullptr && row.text("change") == word_of(Change::gone)) continue;
        waiting_[key_of_ids(id_in(row, "a"), id_in(row, "b"), join_)].push_back(lines_.size());
        lines_.emplace_back(line);
    }
    met_.resize(lines_.size());
    counts_.gone = lines_.size();
    for (auto& [key, rows] : waiting_) std::reverse(rows.begin(), rows.end());
}

std::string Baseline::key_of(Pair pair, const CollisionNames& names) const {
    return key_of_ids(id_of(pair.a, names.a), id_of(pair.b, names.b), join_);
}

std::vector<Change> Baseline::compare(std::span<const Pair> pairs, const CollisionNames& names) {
    std::vector<Change> changes;
    changes.reserve(pairs.size());
    for (const Pair pair : pairs) {
        const auto old = waiting_.find(key_of(pair, names));
        if (old == waiting_.end() || old->second.empty()) {
            changes.push_back(Change::begun);
            ++counts_.begun;
            continue;
        }
        met_[old->second.back()] = true;
        old->second.pop_back();
        changes.push_back(Change::same);
        ++counts_.same;
        --counts_.gone;
    }
    return changes;
}

std::vector<std::string_view> Baseline::gone() const {
    std::vector<std::string_view> gone;
    for (std::size_t i = 0; i < lines_.size(); ++i) {
        if (!met_[i]) gone.emplace_back(lines_[i]);
    }
    return gone;
}

ChangeCounts Baseline::counts() const { return counts_; }

}  // namespace octopair::io
