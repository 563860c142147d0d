#include "cli/view/report_view.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>

#include "cli/view/shown_scene.hpp"
#include "octopair/error.hpp"
#include "viewer/scene/page_file.hpp"

namespace octopair::cli {

namespace {

constexpr std::size_t max_collisions = 200'000;
constexpr std::uint64_t max_report_bytes = std::uint64_t(32) << 20;  ///< of the page, before it is compressed

/// The frame of a report, whose collisions are known.
class KnownFrame final : public viewer::FrameFinder {
public:
    explicit KnownFrame(viewer::FrameData data) : data_(std::move(data)) {}
    std::uint64_t frames() const override { return 1; }
    viewer::FrameData find(std::uint64_t, const ProgressSink&) override { return data_; }

private:
    viewer::FrameData data_;
};

/// Returns the boxes of both sets in float64.
std::vector<Box3d> all_boxes(const InputSet& first, const InputSet* second) {
    std::vector<Box3d> all;
    for (const InputSet* set : {&first, second}) {
        if (set == nullptr) continue;
        const Boxes boxes = set->frame(0).boxes;
        for (std::size_t i = 0; i < set->scene.objects; ++i) all.push_back(viewer::box_of(boxes, i));
    }
    return all;
}

/// Appends the objects of a second set.
void append(viewer::SceneContents& contents, viewer::SceneContents&& other) {
    const std::uint64_t objects = contents.objects + other.objects;
    const auto join = [&](auto& to, auto& from, const auto& unknown) {
        if (to.empty() && from.empty()) return;
        to.resize(std::size_t(contents.objects), unknown);
        from.resize(std::size_t(other.objects), unknown);
        to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
    };
    for (std::uint32_t& shape : other.geometry) {
        if (shape != viewer::SceneContents::no_shape) shape += std::uint32_t(contents.shapes.size());
    }
    join(contents.names, other.names, std::string());
    join(contents.groups, other.groups, 1u);
    join(contents.geometry, other.geometry, viewer::SceneContents::no_shape);
    join(contents.poses, other.poses, Pose());
    std::move(other.shapes.begin(), other.shapes.end(), std::back_inserter(contents.shapes));
    contents.objects = objects;
}

/// Returns the order of pairs by a, then b.
std::vector<std::size_t> ascending(const std::vector<Pair>& pairs) {
    std::vector<std::size_t> order(pairs.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t k) { return pairs[i] < pairs[k]; });
    return order;
}

}  // namespace

ReportView::ReportView(const DetectRequest& request, const InputSet& first, const InputSet* second)
    : request_(request), first_(first), second_(second) {}

void ReportView::add(std::span<const Pair> pairs, std::span<const Finding> findings) {
    const auto offset = std::uint32_t(second_ == nullptr ? 0 : first_.scene.objects);
    for (std::size_t i = 0; i < pairs.size() && pairs_.size() < max_collisions; ++i) {
        pairs_.push_back({pairs[i].a, pairs[i].b + offset});
        findings_.push_back(findings.empty() ? Finding() : findings[i]);
    }
}

std::string ReportView::page() const {
    const std::vector<Box3d> boxes = all_boxes(first_, second_);
    viewer::FrameData data;
    data.boxes = std::span<const Box3d>(boxes);
    for (const std::size_t i : ascending(pairs_)) {
        data.pairs.push_back(pairs_[i]);
        data.findings.push_back(findings_[i]);
    }
    data.pair_count = data.pairs.size();
    viewer::SceneContents contents = shown_scene(request_, first_);
    if (second_ != nullptr) append(contents, shown_scene(request_, *second_));
    contents.title = "Collisions";
    contents.notices.clear();  // the report has them
    KnownFrame finder(std::move(data));
    viewer::SceneSource source(std::move(contents), finder);
    source.load({});
    std::string html;
    try {
        viewer::write_page(
            source, [&](std::string_view text) { html += text; }, max_report_bytes);
    } catch (const Error& error) {
        if (error.code() == ErrorCode::resource_limit) return {};
        throw;
    }
    return viewer::base64(viewer::gzip(html, 6));
}

}  // namespace octopair::cli
