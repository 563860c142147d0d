#include "verification/row_search.hpp"

#include <algorithm>
#include <variant>

namespace octopair {

namespace {

template <typename Real>
Box3d widened(const Box<Real>& box) {
    return {{double(box.min[0]), double(box.min[1]), double(box.min[2])},
            {double(box.max[0]), double(box.max[1]), double(box.max[2])}};
}

Box3d box_of(const Objects& set, std::uint32_t index) {
    return std::visit([&](auto boxes) { return widened(boxes[index]); }, set.boxes);
}

double padding_of(const Objects& set, std::uint32_t index) { return set.padding.empty() ? 0 : set.padding[index]; }

template <typename Tree>
Tree make_tree(const Objects& set, Team& team, const std::stop_token& stop) {
    return std::visit(
        [&]<typename Real>(std::span<const Box<Real>> boxes) {
            return Tree(std::in_place_type<BoxTree<Real>>, boxes, set.padding, team, stop);
        },
        set.boxes);
}

}  // namespace

RowSearch::RowSearch(const SearchedObjects& objects, Team& team, const std::stop_token& stop)
    : first_(objects.first),
      second_(objects.second != nullptr ? *objects.second : Objects{}),
      join_(objects.second != nullptr),
      margin_(objects.margin),
      allows_(objects.allows),
      tree_(make_tree<Tree>(searched(), team, stop)) {}

BoxQuery RowSearch::query_of(std::uint32_t a) const {
    return {box_of(first_, a), padding_of(first_, a), margin_, join_ ? -1 : std::int64_t(a)};
}

void RowSearch::row(std::uint32_t a, std::vector<std::uint32_t>& columns) const {
    unordered_row(a, columns);
    std::sort(columns.begin(), columns.end());
}

void RowSearch::unordered_row(std::uint32_t a, std::vector<std::uint32_t>& columns) const {
    columns.clear();
    const BoxQuery query = query_of(a);
    std::visit([&](const auto& tree) { tree.find(query, columns); }, tree_);
    if (allows_) std::erase_if(columns, [&](std::uint32_t b) { return !allows_(a, b); });
}

bool RowSearch::is_pair(std::uint32_t a, std::uint32_t b) const {
    if (allows_ && !allows_(a, b)) return false;
    return is_within_reach(query_of(a), box_of(searched(), b), padding_of(searched(), b));
}

}  // namespace octopair
