#include "io/results/bcf/bcf_topics.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#define XXH_INLINE_ALL
#include <fmt/format.h>
#include <xxhash.h>

#include "geometry/vector.hpp"
#include "io/formats/unit_change.hpp"
#include "io/results/collision_key.hpp"

namespace octopair::io {

namespace {

double half_diagonal(const Box3d& box) {
    Point3d half;
    for (std::size_t axis = 0; axis < 3; ++axis) half[axis] = (box.max[axis] - box.min[axis]) / 2;
    return vector::length(half);
}

/// Returns the common part of two boxes; on an axis where they are apart, the gap.
Box3d common_part(const Box3d& a, const Box3d& b) {
    Box3d common;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double low = std::max(a.min[axis], b.min[axis]), high = std::min(a.max[axis], b.max[axis]);
        std::tie(common.min[axis], common.max[axis]) = std::minmax(low, high);
    }
    return common;
}

/// Returns the radius of a ball around the contact of two objects that a picture must show: the common part of their boxes, and some of
/// the smaller object around it.
double radius_of(const Box3d& a, const Box3d& b) {
    const double common = half_diagonal(common_part(a, b)), smaller = std::min(half_diagonal(a), half_diagonal(b));
    return std::max({common, std::min(smaller, 4 * common), smaller / 10});
}

bool is_ifc_id(std::string_view id) {
    constexpr std::size_t length = 22;
    return id.size() == length && std::all_of(id.begin(), id.end(), [](char c) {
               return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_' ||
                      c == '$';
           });
}

}  // namespace

std::string guid_of(std::string_view text) {
    const XXH128_hash_t hash = XXH3_128bits(text.data(), text.size());
    constexpr std::uint64_t version = 0x8000, variant = std::uint64_t(1) << 63;
    const std::uint64_t high = (hash.high64 & ~std::uint64_t(0xF000)) | version;
    const std::uint64_t low = (hash.low64 & ~(std::uint64_t(3) << 62)) | variant;
    return fmt::format("{:08x}-{:04x}-{:04x}-{:04x}-{:012x}", high >> 32, high >> 16 & 0xFFFF, high & 0xFFFF, low >> 48,
                       low & 0xFFFFFFFFFFFF);
}

void BcfTopics::add(const CollisionRows& rows) {
    for (std::size_t i = 0; i < rows.pairs.size(); ++i) {
        const Pair pair = rows.pairs[i];
        const Finding found = rows.findings.empty() ? Finding() : rows.findings[i];
        Row row{{pair.a, 0},
                {pair.b, scene_.join ? 1U : 0U},
                found.collision_class,
                found.depth_kind,
                found.depth,
                found.distance,
                {},
                Status::begun,
                {}};
        if (found.collision_class == CollisionClass::clearance) {
            for (std::size_t axis = 0; axis < 3; ++axis)
                row.place[axis] = (found.nearest[0][axis] + found.nearest[1][axis]) / 2;
        } else {
            row.place = found.contacts.empty() ? middle_of(row.a, row.b) : found.contacts.front().point;
        }
        if (!rows.statuses.empty()) {
            row.status = rows.statuses[i].status;
            row.comment = rows.statuses[i].comment;
        }
        rows_.push_back(std::move(row));
    }
}

const ObjectNames& BcfTopics::names_of(const Object& object) const {
    return object.set == 0 ? scene_.form.names.a : scene_.form.names.b;
}

Box3d BcfTopics::box_of(const Object& object) const {
    return std::visit(
        [&](auto span) {
            const auto& box = span[object.number];
            Box3d wide;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                wide.min[axis] = double(box.min[axis]);
                wide.max[axis] = double(box.max[axis]);
            }
            return wide;
        },
        object.set == 0 ? scene_.a : scene_.b);
}

std::string BcfTopics::key_of(const Row& row) const {
    return collision_key({row.a.number, row.b.number}, scene_.form.names);
}

std::string BcfTopics::title_of(const Object& object) const { return object_title(object.number, names_of(object)); }

Point3d BcfTopics::middle_of(const Object& a, const Object& b) const {
    const Box3d common = common_part(box_of(a), box_of(b));
    Point3d middle;
    for (std::size_t axis = 0; axis < 3; ++axis) middle[axis] = common.min[axis] / 2 + common.max[axis] / 2;
    return middle;
}

/// Returns what the row says besides its objects, for example "penetrating, at least 0.02 m deep, at (1, 2, 3)".
std::string BcfTopics::text_of(const Row& row) const {
    const double metres = metres_of(scene_.space.unit).value_or(1);
    const std::string_view unit = scene_.space.unit.empty() ? "" : " m";
    std::string text(word_of(row.collision_class));
    if (row.collision_class == CollisionClass::clearance) {
        text += fmt::format(", {:.4g}{} apart", row.distance * metres, unit);
    } else if (row.depth_kind != DepthKind::unknown) {
        const bool bound = row.depth_kind == DepthKind::at_least;
        text += fmt::format(", {}{:.4g}{} deep", bound ? "at least " : "", row.depth * metres, unit);
    }
    return text + fmt::format(", at ({:.6g}, {:.6g}, {:.6g})", row.place[0] * metres, row.place[1] * metres,
                              row.place[2] * metres);
}

BcfComponent BcfTopics::component_of(const Object& object) const {
    const std::string_view id = names_of(object).detail(object.number, Detail::id);
    if (is_ifc_id(id)) return {std::string(id), {}};
    return {{}, object_key(object.number, names_of(object))};
}

BcfCamera BcfTopics::camera_of(const Row& row) const {
    const bool y_up = scene_.space.up == UpAxis::y;
    const Point3d axis_up = y_up ? Point3d{0, 1, 0} : Point3d{0, 0, 1};
    const Point3d slope = y_up ? Point3d{0.5, -0.5, -0.75} : Point3d{0.5, 0.75, -0.5};
    BcfCamera camera;
    camera.direction = vector::times(slope, 1 / vector::length(slope));
    const Point3d across = vector::cross(camera.direction, axis_up);
    const Point3d up = vector::cross(across, camera.direction);
    camera.up = vector::times(up, 1 / vector::length(up));
    constexpr double half_view = field_of_view / 2 * 3.14159265358979323846 / 180, border = 1.2;
    const double metres = metres_of(scene_.space.unit).value_or(1);
    const double away = border * radius_of(box_of(row.a), box_of(row.b)) / std::sin(half_view);
    camera.place = vector::times(vector::minus(row.place, vector::times(camera.direction, away)), metres);
    return camera;
}

void BcfTopics::add_file(const Object& object, BcfTopic& topic) const {
    const ObjectNames& names = names_of(object);
    if (names.sources.empty()) return;
    const ObjectSource& source = names.source(object.number);
    BcfFile file{std::filesystem::path(source.path).filename().string(),
                 is_ifc_id(source.project) ? std::string(source.project) : std::string()};
    const auto same = [&](const BcfFile& other) { return other.name == file.name && other.project == file.project; };
    if (std::none_of(topic.files.begin(), topic.files.end(), same)) topic.files.push_back(std::move(file));
}

void BcfTopics::add_comment(const Row& row, BcfTopic& topic) const {
    if (!row.comment.empty()) topic.comments.push_back({guid_of("comment " + key_of(row)), row.comment});
}

std::vector<BcfTopics::Group> BcfTopics::groups(std::vector<bool>& grouped) const {
    std::map<Object, std::vector<std::size_t>> rows_of;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        rows_of[rows_[i].a].push_back(i);
        rows_of[rows_[i].b].push_back(i);
    }
    using Rank = std::tuple<std::size_t, std::string, Object>;  // most rows first, then the lesser key
    std::map<Object, std::size_t> left;
    std::set<Rank> ranked;
    const auto rank_of = [&](const Object& object) {
        return Rank{rows_.size() - left[object], object_key(object.number, names_of(object)), object};
    };
    for (const auto& [object, rows] : rows_of) {
        left[object] = rows.size();
        if (rows.size() >= rows_of_group) ranked.insert(rank_of(object));
    }
    std::vector<Group> groups;
    while (!ranked.empty()) {
        const Object element = std::get<Object>(*ranked.begin());
        ranked.erase(ranked.begin());
        if (left[element] < rows_of_group) break;
        Group& group = groups.emplace_back(Group{element, {}});
        for (const std::size_t i : rows_of[element]) {
            if (grouped[i]) continue;
            grouped[i] = true;
            group.rows.push_back(i);
            const Object other = rows_[i].a == element ? rows_[i].b : rows_[i].a;
            const bool was_ranked = ranked.erase(rank_of(other)) > 0;
            --left[other];
            if (was_ranked) ranked.insert(rank_of(other));
        }
    }
    return groups;
}

BcfTopic BcfTopics::topic_of(const Row& row) const {
    const std::string key = key_of(row);
    BcfTopic topic{guid_of("topic " + key), guid_of("viewpoint " + key), {}, {}, {}, row.status, {}, {}, {}, {}};
    topic.title = fmt::format("{} and {}", title_of(row.a), title_of(row.b));
    topic.description = text_of(row);
    topic.label = word_of(row.collision_class);
    for (const Object& object : {row.a, row.b}) {
        add_file(object, topic);
        topic.components.push_back(component_of(object));
    }
    add_comment(row, topic);
    topic.camera = camera_of(row);
    return topic;
}

BcfTopic BcfTopics::topic_of(const Group& group) const {
    const std::string key = object_key(group.element.number, names_of(group.element));
    BcfTopic topic{
        guid_of("group " + key), guid_of("viewpoint of group " + key), {}, {}, {}, Status::resolved, {}, {}, {}, {}};
    topic.title = fmt::format("{}: {} collisions", title_of(group.element), group.rows.size());
    topic.label = word_of(rows_[group.rows.front()].collision_class);
    topic.components.push_back(component_of(group.element));
    add_file(group.element, topic);
    const Row* worst = nullptr;
    for (const std::size_t i : group.rows) {
        const Row& row = rows_[i];
        const Object& other = row.a == group.element ? row.b : row.a;
        topic.description +=
            fmt::format("{}{}: {}", topic.description.empty() ? "" : "\n", title_of(other), text_of(row));
        if (topic.components.size() < max_components) topic.components.push_back(component_of(other));
        add_file(other, topic);
        add_comment(row, topic);
        topic.status = std::min(topic.status, row.status);
        if (topic.label != word_of(row.collision_class)) topic.label.clear();
        const auto severity = [](const Row& one) {
            return std::pair(meet(one.collision_class), one.depth - one.distance);
        };
        if (worst == nullptr || severity(*worst) < severity(row)) worst = &row;
    }
    topic.camera = camera_of(*worst);
    return topic;
}

std::vector<BcfTopic> BcfTopics::topics() const {
    std::vector<bool> grouped(rows_.size());
    std::vector<BcfTopic> topics;
    for (const Group& group : groups(grouped)) topics.push_back(topic_of(group));
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        if (!grouped[i]) topics.push_back(topic_of(rows_[i]));
    }
    return topics;
}

}  // namespace octopair::io
