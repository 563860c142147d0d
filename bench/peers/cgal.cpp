// CGAL's box_self_intersection_d (Zomorodian and Edelsbrunner's hybrid algorithm), serial and parallel. GPL: used only
// here, never in installed code.
#define CGAL_LINKED_WITH_TBB
#include <CGAL/Box_intersection_d/Box_d.h>
#include <CGAL/box_intersection_d.h>
#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/global_control.h>

#include "peers/contender.hpp"

namespace octopair::bench {

namespace {

/// Box with the number of its object.
struct NumberedBox : CGAL::Box_intersection_d::Box_d<float, 3, CGAL::Box_intersection_d::ID_EXPLICIT> {
    using Base = CGAL::Box_intersection_d::Box_d<float, 3, CGAL::Box_intersection_d::ID_EXPLICIT>;
    NumberedBox(const float* min, const float* max, std::uint32_t number)
        : Base(const_cast<float*>(min), const_cast<float*>(max)), object(number) {}
    std::uint32_t object;
};

class Cgal : public CollectingContender {
public:
    Cgal(unsigned threads, std::ptrdiff_t cutoff) : threads_(threads), cutoff_(cutoff) {}

    void run(std::span<const Box3f> boxes) override {
        boxes_.clear();
        boxes_.reserve(boxes.size());
        for (std::uint32_t i = 0; i < boxes.size(); ++i) boxes_.emplace_back(boxes[i].min, boxes[i].max, i);
        pairs_.clear();
        threads_ == 1 ? serial() : parallel();
    }

private:
    void serial() {
        CGAL::box_self_intersection_d(
            boxes_.begin(), boxes_.end(),
            [&](const NumberedBox& a, const NumberedBox& b) {
                pairs_.push_back({a.object, b.object});
            },
            cutoff_);
    }

    void parallel() {
        const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads_);
        oneapi::tbb::enumerable_thread_specific<std::vector<Pair>> found;
        CGAL::box_self_intersection_d<CGAL::Parallel_tag>(
            boxes_.begin(), boxes_.end(),
            [&](const NumberedBox& a, const NumberedBox& b) {
                found.local().push_back({a.object, b.object});
            },
            cutoff_);
        for (const auto& some : found) pairs_.insert(pairs_.end(), some.begin(), some.end());
    }

    unsigned threads_;
    std::ptrdiff_t cutoff_;
    std::vector<NumberedBox> boxes_;
};

}  // namespace

std::vector<ContenderKind> cgal_contenders() {
    return {
        {"CGAL cutoff 10", true, false,
         [](unsigned k) -> std::unique_ptr<Contender> { return std::make_unique<Cgal>(k, 10); }},
        {"CGAL cutoff 1000", true, false,
         [](unsigned k) -> std::unique_ptr<Contender> { return std::make_unique<Cgal>(k, 1000); }},
    };
}

}  // namespace octopair::bench
