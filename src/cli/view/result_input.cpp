// A result without its scene: the objects are drawn where their contacts are, because their boxes are not known.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "cli/view/view.hpp"
#include "io/results/result_file.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

namespace {

constexpr std::uint64_t max_placed_objects = 10'000'000;  ///< 0.5 GB for each frame that is kept

void widen(Box3d& box, const Point3d& point) {
    for (std::size_t i = 0; i < 3; ++i) {
        box.min[i] = std::min(box.min[i], point[i]);
        box.max[i] = std::max(box.max[i], point[i]);
    }
}

Box3d empty_box() {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return {{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
}
bool is_empty(const Box3d& box) { return !(box.min[0] <= box.max[0]); }

class PlacesFinder final : public viewer::FrameFinder {
public:
    explicit PlacesFinder(io::ResultFile result) : result_(std::move(result)) {}

    std::uint64_t frames() const override { return result_.frames.size(); }

    viewer::FrameData find(std::uint64_t number, const ProgressSink&) override {
        io::ResultFrame frame = result_.frames.frame(number);
        auto boxes = std::make_shared<std::vector<Box3d>>(std::size_t(result_.objects), empty_box());
        Box3d all = empty_box();
        for (std::size_t i = 0; i < frame.findings.size(); ++i) {
            const auto [a, b] = frame.pairs[i];
            for (const Contact& contact : frame.findings[i].contacts) {
                for (Box3d* box : {&(*boxes)[a], &(*boxes)[b], &all}) widen(*box, contact.point);
            }
        }
        viewer::FrameData data;
        data.exists.resize(boxes->size());
        const double extent =
            is_empty(all) ? 0 : std::max({all.max[0] - all.min[0], all.max[1] - all.min[1], all.max[2] - all.min[2]});
        const double size = extent > 0 ? 0.002 * extent : 1;
        for (std::size_t i = 0; i < boxes->size(); ++i) {
            Box3d& box = (*boxes)[i];
            data.exists[i] = is_empty(box) ? 0 : 1;
            if (is_empty(box)) box = {{0, 0, 0}, {0, 0, 0}};
            for (std::size_t axis = 0; axis < 3; ++axis) {
                box.min[axis] -= size;
                box.max[axis] += size;
            }
        }
        data.boxes = std::span<const Box3d>(*boxes);
        data.keep = boxes;
        data.pair_count = frame.pairs.size();
        data.pairs = std::move(frame.pairs);
        data.findings = std::move(frame.findings);
        return data;
    }

private:
    io::ResultFile result_;
};

}  // namespace

LoadedView load_result(const ViewRequest& request, const std::stop_token& stop) {
    io::ResultFile result = io::read_result(request.result, stop);
    if (result.objects > max_placed_objects) {
        throw Error(ErrorCode::resource_limit,
                    fmt::format("{}: object {}: without the scene, at most {} objects are shown; name the scene, too",
                                request.result, result.objects - 1, max_placed_objects));
    }
    LoadedView view;
    view.contents.title = request.result.substr(request.result.rfind('/') + 1);
    view.contents.objects = result.objects;
    view.contents.moving = result.moving && result.frames.size() > 1;
    view.contents.up = axis_word(request.detect.pipeline.space.up);
    view.contents.has_boxes = false;
    if (!result.names.empty()) {
        view.contents.names.resize(std::size_t(result.objects));
        for (const auto& [object, name] : result.names) view.contents.names[object] = name;
    }
    view.contents.contacts = result.frames.has_contacts();
    view.contents.notices.push_back(view.contents.contacts
                                        ? "A result has no boxes: objects are drawn around their contacts. Name the "
                                          "scene, too, to see its objects."
                                        : "This result has neither boxes nor contacts, so nothing is drawn. Name the "
                                          "scene, too, to see its objects.");
    view.finder = std::make_unique<PlacesFinder>(std::move(result));
    return view;
}

}  // namespace octopair::cli
