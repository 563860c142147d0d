#include "adapters/cgal/calls.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <memory>

#ifdef OCTOPAIR_TEST_CGAL
#include <CGAL/Box_intersection_d/Box_d.h>
#include <CGAL/Box_intersection_d/Box_with_handle_d.h>
#include <CGAL/box_intersection_d.h>
namespace library = CGAL;
#else
#include "octopair/cgal/box_intersection_d.hpp"
namespace library = octopair::cgal;
#endif

#ifdef OCTOPAIR_TEST_CGAL
namespace octopair::test::with_cgal {
#else
namespace octopair::test::with_octopair {
#endif

namespace {

namespace boxes = library::Box_intersection_d;

boxes::Topology topology_of(const Question& question) { return question.closed ? boxes::CLOSED : boxes::HALF_OPEN; }

/// A box with its position in the sequence.
template <class Number, class Policy = boxes::ID_EXPLICIT>
class Numbered : public boxes::Box_d<Number, 3, Policy> {
public:
    Numbered(std::array<Number, 3> lower, std::array<Number, 3> upper, std::size_t at)
        : boxes::Box_d<Number, 3, Policy>(lower.data(), upper.data()), position(at) {}

    std::size_t position;
};

template <class Number>
std::array<Number, 3> numbers(const double (&corner)[3]) {
    return {Number(corner[0]), Number(corner[1]), Number(corner[2])};
}

template <class Box, class Number>
std::vector<Box> numbered(const std::vector<Corners>& all) {
    std::vector<Box> made;
    made.reserve(all.size());
    for (const Corners& one : all) made.emplace_back(numbers<Number>(one.min), numbers<Number>(one.max), made.size());
    return made;
}

/// Collects the positions of pairs.
class Report {
public:
    explicit Report(bool is_one_sequence) : is_one_sequence_(is_one_sequence) {}
    void add(std::size_t a, std::size_t b) {
        found_->emplace_back(is_one_sequence_ ? std::min(a, b) : a, is_one_sequence_ ? std::max(a, b) : b);
    }
    template <class Box>
        requires requires(const Box& box) { box.position; }
    void operator()(const Box& a, const Box& b) {
        add(a.position, b.position);
    }
    template <class Box>
    void operator()(const Box* a, const Box* b) {
        add(a->position, b->position);
    }
    Positions sorted() const {
        std::sort(found_->begin(), found_->end());
        return *found_;
    }

private:
    bool is_one_sequence_;
    std::shared_ptr<Positions> found_ = std::make_shared<Positions>();  // shared, because calls copy their callback
};

template <class Number, class Policy>
Positions self(const Question& question) {
    auto all = numbered<Numbered<Number, Policy>, Number>(question.first);
    Report report(true);
    library::box_self_intersection_d(all.begin(), all.end(), report, question.cutoff, topology_of(question));
    return report.sorted();
}

Positions self_of_pointers(const Question& question) {
    const auto all = numbered<Numbered<double>, double>(question.first);
    std::vector<const Numbered<double>*> pointers;
    for (const auto& one : all) pointers.push_back(&one);
    Report report(true);
    library::box_self_intersection_d(pointers.begin(), pointers.end(), report, question.cutoff, topology_of(question));
    return report.sorted();
}

Positions self_in_parallel(const Question& question) {
    auto all = numbered<Numbered<double>, double>(question.first);
    Report report(true);
#ifdef OCTOPAIR_TEST_CGAL
    library::box_self_intersection_d(all.begin(), all.end(), report, question.cutoff, topology_of(question));
#else
    library::box_self_intersection_d<library::Parallel_tag>(all.begin(), all.end(), report, question.cutoff,
                                                            topology_of(question));
#endif
    return report.sorted();
}

Positions self_of_all_pairs(const Question& question) {
    auto all = numbered<Numbered<double>, double>(question.first);
    Report report(true);
    library::box_self_intersection_all_pairs_d(all.begin(), all.end(), report, topology_of(question));
    return report.sorted();
}

using Handle = std::vector<Corners>::const_iterator;

/// Boxes that refer to the corners they were made from.
std::vector<boxes::Box_with_handle_d<double, 3, Handle>> referring(const std::vector<Corners>& all) {
    std::vector<boxes::Box_with_handle_d<double, 3, Handle>> made;
    for (Handle one = all.begin(); one != all.end(); ++one) {
        auto lower = numbers<double>(one->min), upper = numbers<double>(one->max);
        made.emplace_back(lower.data(), upper.data(), one);
    }
    return made;
}

Positions self_of_handles(const Question& question) {
    auto all = referring(question.first);
    Report report(true);
    const auto position = [&](const auto& box) { return std::size_t(box.handle() - question.first.begin()); };
    library::box_self_intersection_d(
        all.begin(), all.end(), [&](const auto& a, const auto& b) { report.add(position(a), position(b)); },
        question.cutoff, topology_of(question));
    return report.sorted();
}

/// Access to positions of boxes in a sequence: traits of a program's own type.
struct OwnTraits {
    using Box_parameter = const std::pair<const Corners*, std::size_t>&;
    using NT = double;
    using ID = std::size_t;
    static double min_coord(Box_parameter box, int axis) { return box.first->min[axis]; }
    static double max_coord(Box_parameter box, int axis) { return box.first->max[axis]; }
    static std::size_t id(Box_parameter box) { return box.second; }
    static int dimension() { return 3; }
};

std::vector<std::pair<const Corners*, std::size_t>> own(const std::vector<Corners>& all, std::size_t first_id) {
    std::vector<std::pair<const Corners*, std::size_t>> made;
    for (const Corners& one : all) made.emplace_back(&one, first_id + made.size());
    return made;
}

Positions self_with_own_traits(const Question& question) {
    auto all = own(question.first, 0);
    Report report(true);
    library::box_self_intersection_d(
        all.begin(), all.end(), [&](const auto& a, const auto& b) { report.add(a.second, b.second); }, OwnTraits(),
        question.cutoff, topology_of(question));
    return report.sorted();
}

/// Several boxes have the same id, which CGAL's function of all pairs ignores.
Positions self_of_all_pairs_with_equal_ids(const Question& question) {
    auto all = own(question.first, 0);
    for (auto& [box, id] : all) id %= 7;
    Report report(true);
    const auto position = [&](const auto& one) { return std::size_t(one.first - question.first.data()); };
    library::box_self_intersection_all_pairs_d(
        all.begin(), all.end(), [&](const auto& a, const auto& b) { report.add(position(a), position(b)); },
        OwnTraits(), topology_of(question));
    return report.sorted();
}

template <class Number>
Positions two(const Question& question) {
    auto first = numbered<Numbered<Number>, Number>(question.first);
    auto second = numbered<Numbered<Number>, Number>(question.second);
    Report report(false);
    library::box_intersection_d(first.begin(), first.end(), second.begin(), second.end(), report, question.cutoff,
                                topology_of(question));
    return report.sorted();
}

/// Ids of both sequences begin at 0. Boxes with the same id do not make a pair.
Positions two_with_common_ids(const Question& question) {
    auto first = own(question.first, 0), second = own(question.second, 0);
    Report report(false);
    library::box_intersection_d(
        first.begin(), first.end(), second.begin(), second.end(),
        [&](const auto& a, const auto& b) { report.add(a.second, b.second); }, OwnTraits(), question.cutoff,
        topology_of(question), boxes::BIPARTITE);
    return report.sorted();
}

Positions complete(const Question& question) {
    auto first = numbered<Numbered<double>, double>(question.first);
    auto second = first;
    Report report(true);
    library::box_intersection_d(first.begin(), first.end(), second.begin(), second.end(), report, question.cutoff,
                                topology_of(question), boxes::COMPLETE);
    return report.sorted();
}

Positions two_of_all_pairs(const Question& question) {
    auto first = numbered<Numbered<double>, double>(question.first);
    auto second = numbered<Numbered<double>, double>(question.second);
    Report report(false);
    library::box_intersection_all_pairs_d(first.begin(), first.end(), second.begin(), second.end(), report,
                                          topology_of(question));
    return report.sorted();
}

/// Two boxes among the 27 cubes of a grid.
Positions grid(const Question& question) {
    std::vector<Corners> cubes;
    for (const double x : {0.0, 1.0, 2.0}) {
        for (const double y : {0.0, 1.0, 2.0}) {
            for (const double z : {0.0, 1.0, 2.0}) cubes.push_back({{x, y, z}, {x + 1, y + 1, z + 1}});
        }
    }
    const std::vector<Corners> wanted = {{{1, 1, 1}, {2, 2, 2}}, {{0, 0, 0}, {1, 3, 0.5}}};
    return two<double>({cubes, wanted, question.closed, question.cutoff});
}

/// The triangles of a mesh whose boxes intersect and that share no vertex. Vertex i is the lower corner of box i.
Positions triangles(const Question& question) {
    using Triangle = std::array<std::size_t, 3>;
    std::vector<Triangle> mesh;
    for (std::size_t i = 0; i + 2 < question.first.size(); ++i) mesh.push_back({i, i + 1, i + 2});
    std::vector<boxes::Box_with_handle_d<double, 3, const Triangle*>> all;
    for (const Triangle& triangle : mesh) {
        boxes::Box_with_handle_d<double, 3, const Triangle*> box(&triangle);
        box.init();
        for (const std::size_t vertex : triangle) {
            auto corner = numbers<double>(question.first[vertex].min);
            box.extend(corner.data());
        }
        all.push_back(box);
    }
    Report report(true);
    library::box_self_intersection_d(all.begin(), all.end(), [&](const auto& a, const auto& b) {
        const auto first = std::size_t(a.handle() - mesh.data()), second = std::size_t(b.handle() - mesh.data());
        if (first + 2 < second || second + 2 < first) report.add(first, second);
    });
    return report.sorted();
}

/// Points that are nearer to each other than `eps` on each axis: boxes of half this size around the points, as handles.
Positions near_points(const Question& question) {
    constexpr double eps = 1.5;
    std::vector<boxes::Box_with_handle_d<double, 3, Handle>> all;
    for (Handle at = question.first.begin(); at != question.first.end(); ++at) {
        boxes::Box_with_handle_d<double, 3, Handle> box(at);
        box.init();
        for (const double sign : {-1.0, 1.0}) {
            auto corner = numbers<double>(at->min);
            for (double& one : corner) one += sign * eps / 2;
            box.extend(corner.data());
        }
        all.push_back(box);
    }
    Report report(true);
    const auto position = [&](const auto* box) { return std::size_t(box->handle() - question.first.begin()); };
    std::vector<const boxes::Box_with_handle_d<double, 3, Handle>*> pointers;
    for (const auto& box : all) pointers.push_back(&box);
    library::box_self_intersection_d(pointers.begin(), pointers.end(),
                                     [&](const auto* a, const auto* b) { report.add(position(a), position(b)); });
    return report.sorted();
}

}  // namespace

std::vector<Call> calls() {
    return {{"boxes of double", self<double, boxes::ID_EXPLICIT>},
            {"boxes of float", self<float, boxes::ID_EXPLICIT>},
            {"boxes of int", self<int, boxes::ID_EXPLICIT>},
            {"pointers", self_of_pointers},
            {"parallel", self_in_parallel},
            {"all pairs", self_of_all_pairs},
            {"all pairs with equal ids", self_of_all_pairs_with_equal_ids},
            {"handles", self_of_handles},
            {"own traits", self_with_own_traits},
            {"setting complete", complete},
            {"near points", near_points},
            {"triangles", triangles},
            {"grid", grid},
            {"two sequences of double", two<double>},
            {"two sequences of float", two<float>},
            {"two sequences with common ids", two_with_common_ids},
            {"all pairs of two sequences", two_of_all_pairs}};
}

}  // namespace
