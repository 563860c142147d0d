// The HTML report of `octopair detect --report` (make_report() in found_writer.hpp), with the viewer's page in it.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "cli/detect/pipeline_options.hpp"
#include "cli/input/search_inputs.hpp"
#include "cli/output/found_writer.hpp"
#include "io/files/atomic_file.hpp"
#include "io/results/collision_writer.hpp"
#include "io/results/html_report.hpp"
#ifdef OCTOPAIR_WITH_VIEWER
#include "cli/view/view.hpp"
#include "octopair/error.hpp"
#include "viewer/scene/page_file.hpp"
#endif

namespace octopair::cli {

namespace {

std::string joined(const std::vector<std::string>& words) {
    std::string all;
    for (const std::string& word : words) all += (all.empty() ? "" : ", ") + word;
    return all;
}

#ifdef OCTOPAIR_WITH_VIEWER
/// The viewer's page for a report: the objects of the inputs, and the collisions of the report.
class ReportView {
public:
    /// Borrows the request and the sets. `second` is null unless the result is of a join. Then the objects of the second set have
    /// the numbers after those of the first.
    ReportView(const DetectRequest& request, const InputSet& first, const InputSet* second);

    /// Adds collisions. Only the first 200,000 are kept.
    void add(std::span<const Pair> pairs, std::span<const Finding> findings);
    /// Returns the page, compressed by gzip and in base64. Empty if it would be too large.
    std::string page() const;

private:
    const DetectRequest& request_;
    const InputSet& first_;
    const InputSet* second_;
    std::vector<Pair> pairs_;
    std::vector<Finding> findings_;
};

constexpr std::size_t max_collisions = 200'000;
constexpr std::uint64_t max_report_bytes = std::uint64_t(32) << 20;  ///< maximum size of the uncompressed page

/// FrameFinder that returns the collisions of the report, without a search.
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

/// Returns the indices of the pairs in ascending order of the pairs: by a, then by b.
std::vector<std::size_t> ascending(const std::vector<Pair>& pairs) {
    std::vector<std::size_t> order(pairs.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t k) { return pairs[i] < pairs[k]; });
    return order;
}

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
    contents.notices.clear();  // the report itself prints the notices
    KnownFrame finder(std::move(data));
    viewer::FrameSource source(std::move(contents), finder);
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

/// Writes each collision to the table of the report, and adds it to the viewer's page in the report.
class ReportWithView final : public io::CollisionWriter {
public:
    ReportWithView(std::unique_ptr<io::HtmlReport> report, ReportView view)
        : view_(std::move(view)), report_(std::move(report)) {
        report_->set_viewer([this] { return view_.page(); });
    }

    void write(const io::CollisionRows& rows) override {
        view_.add(rows.pairs, rows.findings);
        report_->write(rows);
    }
    void write_gone(std::span<const std::string_view> lines) override { report_->write_gone(lines); }
    void finish() override { report_->finish(); }

private:
    ReportView view_;
    std::unique_ptr<io::HtmlReport> report_;
};
#endif

}  // namespace

io::SceneSpace space_of_result(const DetectRequest& request, const FoundIn& sets) {
    io::SceneSpace space = request.pipeline.space;
    const io::SceneSpace &first = sets.first.scene.space, &second = sets.second.scene.space;
    if (space.up == io::UpAxis::unknown && first.up == second.up) space.up = first.up;
    if (space.unit.empty()) space.unit = first.unit.empty() ? second.unit : first.unit;
    return space;
}

std::unique_ptr<io::CollisionWriter> make_report(const DetectRequest& request, const FoundIn& sets,
                                                 const io::CollisionForm& form) {
    io::ReportScene scene;
    scene.title = joined(request.inputs) + (request.against.empty() ? "" : " against " + request.against);
    scene.form = form;
    scene.a = sets.first.frame(0).boxes;
    scene.b = sets.second.frame(0).boxes;
    scene.join = !request.against.empty();
    scene.space = space_of_result(request, sets);
    auto report = std::make_unique<io::HtmlReport>(std::make_unique<io::AtomicFile>(request.pipeline.report), scene);
    const std::uint64_t objects = sets.first.scene.objects + (scene.join ? sets.second.scene.objects : 0);
    report->add_fact("objects", fmt::format("{}", objects));
    if (request.margin > 0) report->add_fact("margin", fmt::format("{}", request.margin));
    const SetPair pair{sets.first, scene.join ? &sets.second : nullptr};
    if (form.features) report->add_fact("tolerance", fmt::format("{:.3g}", tolerance_of(request, pair)));
    for (const std::string& warning : input_warnings(request, pair)) report->add_note(warning);
    if (request.limit) report->add_fact("limit", fmt::format("the first {}", *request.limit));
    if (request.pipeline.classes) report->add_fact("classes", class_list(*request.pipeline.classes));
    if (!request.pipeline.exclude.empty()) report->add_fact("excluded by", request.pipeline.exclude);
    if (!request.pipeline.baseline.empty()) report->add_fact("baseline", request.pipeline.baseline);
#ifdef OCTOPAIR_WITH_VIEWER
    return std::make_unique<ReportWithView>(std::move(report), ReportView(request, sets.first, pair.second));
#else
    return report;
#endif
}

}  // namespace octopair::cli
