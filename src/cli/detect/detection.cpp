#include "cli/detect/detection.hpp"

#include <algorithm>
#include <chrono>
#include <memory>

#include "cli/command/progress_line.hpp"
#include "cli/detect/filter_row.hpp"
#include "cli/input/whole_inputs.hpp"
#include "cli/output/found_writer.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

class Detection {
public:
    Detection(const DetectRequest& request, std::stop_token stop)
        : request_(request), stop_(std::move(stop)), progress_(!request.quiet) {}

    DetectReport run() {
        read();
        const auto engine = make_engine(request_.engine);
        if (report_.frames > 1) refuse_faults();  // before anything of the first frames is written
        prepare();
        try {
            request_.count_only ? count(*engine) : stream(*engine);
        } catch (const Error& error) {
            if (error.code() == ErrorCode::bad_input) refuse_faults();
            throw;
        }
        report_.seconds.total = seconds_since(start_);
        return report_;
    }

private:
    void read() {
        progress_.show("reading", 0);
        inputs_.read(request_, stop_);
        report_.frames = inputs_.frames.frames;
        report_.moving = inputs_.frames.moving;
        report_.objects = first_.total + second_.total;
        report_.engine = describe_engine(request_.engine);
        report_.seconds.read = seconds_since(start_);
    }

    void prepare() {
#ifdef OCTOPAIR_WITH_PIPELINE
        if (!has_filters(request_)) return;
        const auto start = Clock::now();
        progress_.show("preparing", 0);
        row_ = make_filter_row(request_, {first_, join() ? &second_ : nullptr}, stop_);
        report_.seconds.prepare = seconds_since(start);
#endif
    }

    void count(Engine& engine) {
        for (std::uint64_t frame = 0; frame < report_.frames; ++frame) search(engine, frame, nullptr);
        progress_.clear();
    }

    /// Without a writer: counts.
    void search(Engine& engine, std::uint64_t frame, FoundWriter* writer) {
        const Options options = call_options(request_, report_, frame, progress_);
        const double written_before = report_.seconds.write;
        const auto written = [&] { return report_.seconds.write - written_before; };
        if (row_ != nullptr) {
            const CollisionSink sink = [&](const Batch& batch) {
                timed_write([&] { writer->write(batch.pairs(), batch.findings()); });
            };
            const PipelineSummary summary =
                row_->run(engine, frame, writer != nullptr ? sink : CollisionSink(), options);
            report_.add(summary, written());
            return;
        }
        const PairSink pairs = [&](std::span<const Pair> batch) { timed_write([&] { writer->write(batch, {}); }); };
        const PairSink sink = writer != nullptr ? pairs : PairSink();
        const Input input(first_.frame(frame), join() ? std::optional(second_.frame(frame)) : std::nullopt);
        const Summary summary = engine.stream_pairs(input, sink, options, stop_);
        report_.add(summary, written());
    }

    void stream(Engine& engine) {
        const auto writer = make_found_writer(request_, {first_, join() ? second_ : first_, report_.moving}, stop_);
        for (std::uint64_t frame = 0; frame < report_.frames; ++frame) {
            timed_write([&] { writer->begin_frame(frame); });
            search(engine, frame, writer.get());
            progress_.clear();
            timed_write([&] { writer->end_frame(); });
        }
        timed_write([&] { writer->finish(); });
        report_.changes = writer->changes();
    }

    template <typename Write>
    void timed_write(const Write& write) {
        const auto start = Clock::now();
        write();
        report_.seconds.write += seconds_since(start);
    }

    /// Says again what the engine found wrong with a box, with the file.
    void refuse_faults() const {
        for (const InputSet* set : {&first_, &second_}) {
            if (const auto fault = set->find_fault()) throw Error(ErrorCode::bad_input, *fault);
        }
    }

    bool join() const { return !request_.against.empty(); }

    const DetectRequest& request_;
    std::stop_token stop_;
    ProgressLine progress_;
    Clock::time_point start_ = Clock::now();
    WholeInputs inputs_;
    const InputSet &first_ = inputs_.first, &second_ = inputs_.second;
    std::unique_ptr<FilterRow> row_;  // none: pairs as they are
    DetectReport report_;
};

}  // namespace

void DetectReport::add_search(const Summary& search) {
    candidates += search.pairs;
    entries += search.entries;
    steps.encode += search.steps.encode;
    steps.scatter += search.steps.scatter;
    steps.count += search.steps.count;
    steps.scan += search.steps.scan;
    add(search.verification);
}

void DetectReport::add(const Verification& verification) {
    verified = verification.done;
    if (not_checked.size() < verification.not_checked.size()) not_checked = verification.not_checked;
    seconds.verify += verification.seconds;
}

void DetectReport::add(const Summary& summary, double written) {
    add_search(summary);
    pairs += summary.pairs;
    truncated |= summary.truncated;
    seconds.detect += std::max(0.0, summary.seconds - written);
}

void DetectReport::add(const PipelineSummary& summary, double written) {
    add_search(summary.search);
    pairs += summary.collisions;
    truncated |= summary.truncated;
    seconds.detect += summary.search.seconds;
    const double search = summary.search.seconds + summary.search.verification.seconds;
    seconds.filter += std::max(0.0, summary.seconds - search - written);
    filters.resize(summary.filters.size());
    for (std::size_t i = 0; i < filters.size(); ++i) {
        const FilterCounts& counts = summary.filters[i];
        filters[i].name = counts.name;
        filters[i].in += counts.in;
        filters[i].out += counts.out;
        filters[i].seconds += counts.seconds;
    }
}

Options call_options(const DetectRequest& request, const DetectReport& report, std::uint64_t frame,
                     ProgressLine& progress) {
    Options options;
    options.order = request.order;
    options.margin = request.margin;
    options.verify = request.verify;
    if (request.limit) options.limit = *request.limit - report.pairs;
    options.progress = [&progress, frame, frames = report.frames](double done) {
        progress.show("detecting", (double(frame) + done) / double(frames));
    };
    return options;
}

DetectReport detect(const DetectRequest& request, const std::stop_token& stop) {
    return Detection(request, stop).run();
}

}  // namespace octopair::cli
