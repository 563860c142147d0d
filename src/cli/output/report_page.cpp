// The HTML report of `octopair detect --report` (make_report() in found_writer.hpp): the page of the viewer with the collisions of the run.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "cli/output/found_writer.hpp"
#include "cli/view/shown_scene.hpp"
#include "io/files/atomic_file.hpp"
#include "io/json/json_fields.hpp"
#include "io/json/json_text.hpp"
#include "io/results/collision_columns.hpp"
#include "io/results/collision_writer.hpp"
#include "octopair/error.hpp"
#include "viewer/scene/page_file.hpp"

namespace octopair::cli {

namespace {

using viewer::SceneContents;

/// FrameFinder that returns the collisions of the report, without a search.
class KnownFrame final : public viewer::FrameFinder {
public:
    explicit KnownFrame(const viewer::FrameData& data) : data_(data) {}
    std::uint64_t frames() const override { return 1; }
    viewer::FrameData find(std::uint64_t, const ProgressSink&) override { return data_; }

private:
    const viewer::FrameData& data_;
};

/// A collision of the report, and its position in the result.
struct ReportRow {
    std::uint64_t number;
    Pair pair;
    Finding finding;
    std::string_view change;
    io::RowStatus status;
};

bool is_worse(const ReportRow& p, const ReportRow& q) {
    const viewer::Severity x = viewer::severity_of(p.finding), y = viewer::severity_of(q.finding);
    return x != y ? x > y : p.number < q.number;
}

viewer::GoneCollision gone_collision(std::string_view line) {
    const nlohmann::json old = io::parse_json(line, "older result");
    const io::CollisionRecord row = io::read_collision({old, "older result"});
    const auto object = [](const io::RecordedObject& recorded) {
        const auto detail = [&](io::Detail what) { return std::string(recorded.details[std::size_t(what)]); };
        std::string name = recorded.name.empty() ? fmt::format("#{}", recorded.number) : std::string(recorded.name);
        if (recorded.triangle) name += fmt::format(", triangle {}", *recorded.triangle);
        return viewer::GoneCollision::Object{std::move(name), detail(io::Detail::label), detail(io::Detail::type),
                                             detail(io::Detail::id)};
    };
    return {{object(row.a), object(row.b)}, io::finding_of(row)};
}

/// Returns for each object whether it has a row.
std::vector<bool> colliding(const SceneContents& contents, const viewer::FrameData& data) {
    std::vector<bool> has_row(std::size_t(contents.objects));
    for (const auto [a, b] : data.pairs) has_row[a] = has_row[b] = true;
    return has_row;
}

/// Takes the shapes of objects without a row out of the scene. Returns whether it had such shapes.
bool drop_free_shapes(SceneContents& contents, const viewer::FrameData& data) {
    const std::vector<bool> has_row = colliding(contents, data);
    std::vector<bool> used(contents.shapes.size());
    for (std::size_t i = 0; i < contents.geometry.size(); ++i) {
        std::uint32_t& shape = contents.geometry[i];
        if (!has_row[i]) shape = SceneContents::no_shape;
        if (shape != SceneContents::no_shape) used[shape] = true;
    }
    bool dropped = false;
    for (std::size_t k = 0; k < used.size(); ++k) {
        if (used[k]) continue;
        dropped |= !contents.shapes[k].triangles.empty();
        contents.shapes[k].vertices.clear();
        contents.shapes[k].triangles.clear();
    }
    return dropped;
}

void drop_all_shapes(SceneContents& contents) {
    contents.shapes.clear();
    contents.geometry.clear();
    contents.poses.clear();
}

class ReportPage final : public io::CollisionWriter {
public:
    /// Borrows the request and the sets.
    ReportPage(const DetectRequest& request, const SetPair& sets)
        : request_(request), sets_(sets), out_(request.pipeline.report) {}

    void write(const io::CollisionRows& rows) override {
        for (std::size_t i = 0; i < rows.pairs.size(); ++i) {
            const Finding finding = rows.findings.empty() ? Finding() : rows.findings[i];
            const std::string_view change = rows.changes.empty() ? std::string_view() : io::word_of(rows.changes[i]);
            ++class_counts_[std::size_t(finding.collision_class)];
            if (!rows.changes.empty()) ++change_counts_[std::size_t(rows.changes[i])];
            const io::RowStatus status = rows.statuses.empty() ? io::RowStatus() : rows.statuses[i];
            rows_.push_back({total_++, rows.pairs[i], finding, change, status});
            if (rows_.size() == 2 * max_rows) keep_worst();
        }
    }

    void write_gone(std::span<const std::string_view> lines) override {
        gone_total_ = lines.size();
        for (const std::string_view line : lines.first(std::min<std::size_t>(lines.size(), max_rows))) {
            gone_.push_back(gone_collision(line));
        }
    }

    void finish() override {
        keep_worst();
        out_.write(page());
        out_.commit();
    }

private:
    static constexpr std::size_t max_rows = viewer::max_listed_pairs;

    /// Drops all rows except the max_rows worst ones.
    void keep_worst() {
        if (rows_.size() <= max_rows) return;
        std::nth_element(rows_.begin(), rows_.begin() + std::ptrdiff_t(max_rows), rows_.end(), is_worse);
        rows_.resize(max_rows);
    }

    /// Returns the collisions, ascending by pair.
    viewer::FrameData frame() {
        std::sort(rows_.begin(), rows_.end(), [](const ReportRow& p, const ReportRow& q) {
            return p.pair != q.pair ? p.pair < q.pair : p.number < q.number;
        });
        viewer::FrameData data;
        show_boxes(data, sets_, 0);
        for (ReportRow& row : rows_) {
            data.pairs.push_back({row.pair.a, row.pair.b + second_offset(sets_)});
            data.findings.push_back(std::move(row.finding));
            if (!row.change.empty()) data.changes.push_back(row.change);
            if (!request_.pipeline.statuses.empty())
                data.statuses.push_back({io::word_of(row.status.status), std::string(row.status.comment)});
        }
        data.pair_count = total_;
        data.class_counts.assign(class_counts_.begin(), class_counts_.end());
        add_changes(data);
        return data;
    }

    void add_changes(viewer::FrameData& data) const {
        if (request_.pipeline.baseline.empty()) return;
        for (const io::Change change : {io::Change::begun, io::Change::same}) {
            data.facts.push_back({std::string(io::word_of(change)), double(change_counts_[std::size_t(change)])});
        }
        data.facts.push_back({std::string(io::word_of(io::Change::gone)), double(gone_total_)});
    }

    /// Returns the page. If it would be too large, the page has fewer shapes, and a notice says so.
    std::string page() {
        const viewer::FrameData data = frame();
        SceneContents contents = shown_scene(request_, sets_);
        contents.gone = std::move(gone_);
        if (const std::uint64_t rows = std::max(total_, gone_total_); rows > max_rows) {
            contents.notices.push_back(fmt::format("The table has the worst {} of {} rows.", max_rows, rows));
        }
        const std::size_t notices = contents.notices.size();
        std::string html = written(contents, data);
        if (html.empty() && drop_free_shapes(contents, data)) {
            contents.notices.emplace_back(
                "Objects that do not collide are drawn as boxes, because the shapes of all are too large.");
            html = written(contents, data);
        }
        if (!html.empty()) return html;
        contents.notices.resize(notices);
        contents.notices.emplace_back("All objects are drawn as boxes, because their shapes are too large.");
        drop_all_shapes(contents);
        return written(contents, data, ~std::uint64_t(0));
    }

    /// Returns the page; an empty text if it would be larger than `most`.
    static std::string written(const SceneContents& contents, const viewer::FrameData& data,
                               std::uint64_t most = viewer::max_page_bytes) {
        KnownFrame finder(data);
        viewer::FrameSource source(contents, finder);
        source.load({});
        std::string html;
        try {
            viewer::write_page(source, [&](std::string_view text) { html += text; }, {most, false});
        } catch (const Error& error) {
            if (error.code() != ErrorCode::resource_limit) throw;
            return {};
        }
        return html;
    }

    const DetectRequest& request_;
    SetPair sets_;
    io::AtomicFile out_;
    std::vector<ReportRow> rows_;
    std::uint64_t total_ = 0, gone_total_ = 0;
    std::array<std::uint64_t, collision_classes> class_counts_ = {};
    std::array<std::uint64_t, 2> change_counts_ = {};  // of rows: new and the same
    std::vector<viewer::GoneCollision> gone_;
};

}  // namespace

io::SceneSpace space_of_result(const DetectRequest& request, const FoundIn& sets) {
    io::SceneSpace space = request.pipeline.space;
    const io::SceneSpace &first = sets.first.scene.space, &second = sets.second.scene.space;
    if (space.up == io::UpAxis::unknown && first.up == second.up) space.up = first.up;
    if (space.unit.empty()) space.unit = first.unit.empty() ? second.unit : first.unit;
    return space;
}

std::unique_ptr<io::CollisionWriter> make_report(const DetectRequest& request, const FoundIn& sets) {
    const bool join = !request.against.empty();
    return std::make_unique<ReportPage>(request, SetPair{sets.first, join ? &sets.second : nullptr});
}

}  // namespace octopair::cli
