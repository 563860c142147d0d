#include "cli/detect/detection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <memory>

#include "base/timed.hpp"
#include "cli/detect/frame_search.hpp"
#include "cli/detect/pipeline_options.hpp"
#include "cli/input/search_inputs.hpp"
#include "io/json/json_fields.hpp"
#include "octopair/error.hpp"
#ifdef OCTOPAIR_WITH_PIPELINE
#include "cli/input/shaped_set.hpp"
#endif

namespace octopair::cli {

namespace {

/// Returns a name of the object for messages: its label and type; without a label its name; without a name its number.
[[maybe_unused]] std::string short_name(const io::LoadedScene& scene, std::uint32_t object) {
    const std::string_view label = scene.details.of(object, io::Detail::label);
    const std::string_view type = scene.details.of(object, io::Detail::type);
    if (!label.empty() && type != label && !type.empty())
        return fmt::format("{} ({})", io::shown_text(label), io::shown_text(type));
    if (!label.empty()) return io::shown_text(label);
    const bool has_name = object < scene.names.size() && !scene.names[object].empty();
    return has_name ? io::shown_text(scene.names[object]) : fmt::format("object {}", object);
}

class Detection {
public:
    Detection(const DetectRequest& request, SearchGroup& searchers, std::stop_token stop)
        : searchers_(searchers), run_{request, std::move(stop), ProgressLine(!request.quiet && group_.first())} {}

    DetectReport run() {
        {
            const Timed timed(report_.seconds.total);
            group_.together([&] { read(); });
            searchers_.compare_inputs(run_);
            search_ = searchers_.make_search(run_);
            if (report_.frames > 1) refuse_invalid_boxes();  // before the first frames are written
            try {
                search_frames();
            } catch (const Error& error) {
                if (error.code() == ErrorCode::bad_input) refuse_invalid_boxes();
                // If an input file changed during the search, an engine or a check may report a contradiction. Report the change instead.
                if (error.code() == ErrorCode::engine_failed && group_.ranks() == 1) run_.check_inputs();
                throw;
            }
        }
        run_.progress.clear();
        return report_;
    }

private:
    void read() {
        const Timed timed(report_.seconds.read);
        run_.progress.show("reading", 0);
        searchers_.read_inputs(run_);
        report_.frames = inputs_.frames.frames;
        report_.moving = inputs_.frames.moving;
        report_.objects = inputs_.first.total + inputs_.second.total;
        report_.engine = describe_engine(request_.engine);
        const bool whole =
            inputs_.first.total == inputs_.first.scene.objects && inputs_.second.total == inputs_.second.scene.objects;
        if (request_.fail_on_collision) {
            refuse_empty_parts(inputs_.first.parts);
            refuse_empty_parts(inputs_.second.parts);
        }
        if (whole) {
            report_.warnings = input_warnings(request_, sets());
            for (const InputSet* set : {&inputs_.first, &inputs_.second}) report_.elements.add(set->scene.elements);
        }
        describe_unit();
#ifdef OCTOPAIR_WITH_PIPELINE
        describe_shapes();
#endif
        searchers_.check_objects(run_);
    }

    void describe_unit() {
        for (const InputSet* set : {&inputs_.first, &inputs_.second}) {
            if (report_.unit.empty()) report_.unit = set->scene.space.unit;
            std::copy_if(set->parts.begin(), set->parts.end(), std::back_inserter(report_.converted),
                         [](const Part& part) { return !part.converted_from.empty(); });
        }
    }

    SetPair sets() const { return {inputs_.first, run_.join() ? &inputs_.second : nullptr}; }

#ifdef OCTOPAIR_WITH_PIPELINE
    void describe_shapes() {
        if (stage_of(request_) == Stage::features) {
            report_.tolerance = tolerance_of(request_, sets());
            report_.tolerance_is_default = !request_.pipeline.tolerance && *report_.tolerance > 0;
            report_.chord = chord_of(request_, sets());
        }
        if (stage_of(request_) == Stage::pairs) return;
        constexpr std::size_t named = 3;
        for (const InputSet* set : {&inputs_.first, &inputs_.second}) {
            if (set->shaped == nullptr) continue;
            const std::vector<std::uint32_t> open = set->shaped->open_objects();
            report_.open_objects += open.size();
            for (std::size_t i = 0; i < open.size() && report_.first_open.size() < named; ++i) {
                report_.first_open.push_back(short_name(set->scene, open[i]));
            }
        }
    }
#endif

    void search_frames() {
        search_->prepare();
        for (std::uint64_t frame = 0; frame < report_.frames; ++frame) search_->search(frame);
        search_->finish();
    }

    /// Throws bad_input with the file and the object of the first invalid box of all ranks. Does nothing if all boxes are valid.
    void refuse_invalid_boxes() {
        group_.together([&] {
            std::uint64_t before = 0;
            for (const InputSet* set : {&inputs_.first, &inputs_.second}) {
                if (const auto invalid = set->find_invalid_box())
                    group_.refuse_object(before + invalid->position, invalid->message);
                before += set->total * set->scene.frames;
            }
        });
    }

    SearchGroup& searchers_;
    Group& group_ = searchers_.processes();
    DetectRun run_;
    const DetectRequest& request_ = run_.request;
    WholeInputs& inputs_ = run_.inputs;
    DetectReport& report_ = run_.report;
    std::unique_ptr<FrameSearch> search_;
};

}  // namespace

Options DetectRun::call_options(std::uint64_t frame) {
    Options options;
    options.order = request.order;
    options.margin = request.margin;
    options.verify = request.verify;
    if (request.limit) options.limit = *request.limit - report.pairs;
    options.progress = [this, frame](double done) {
        progress.show("detecting", (double(frame) + done) / double(report.frames));
    };
    return options;
}

DetectReport detect(const DetectRequest& request, SearchGroup& searchers, const std::stop_token& stop) {
    return Detection(request, searchers, stop).run();
}

}  // namespace octopair::cli
