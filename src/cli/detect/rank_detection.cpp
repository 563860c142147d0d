#include "cli/detect/rank_detection.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/floating_point.hpp"
#include "base/timed.hpp"
#include "cli/command/progress_line.hpp"
#include "cli/input/join.hpp"
#include "cli/input/whole_inputs.hpp"
#include "cli/output/piece_output.hpp"
#include "io/formats.hpp"
#include "octopair/error.hpp"
#include "octopair/mpi.hpp"
#include "verification/verifier.hpp"
#ifdef OCTOPAIR_WITH_PIPELINE
#include "cli/detect/rank_filters.hpp"
#endif

namespace octopair::cli {

namespace {

/// Returns the same objects, numbered from rank to rank.
IndexedInput unindexed(const Input& input) {
    std::optional<IndexedObjects> second;
    if (input.second) second = {*input.second, {}};
    return {IndexedObjects{input.first, {}}, second};
}

class RankDetection {
public:
    RankDetection(const DetectRequest& request, Cluster& cluster, std::stop_token stop)
        : request_(request), cluster_(cluster), stop_(std::move(stop)), progress_(!request.quiet && cluster.first()) {}

    DetectReport run() {
        {
            const Timed timed(report_.seconds.total);
            read_and_find();
        }
        progress_.clear();
        return report_;
    }

private:
    void read_and_find() {
        cluster_.together([&] { read(); });
        cluster_.joint([&] { engine_ = make_mpi_engine(MPI_COMM_WORLD, {.threads = report_.engine.threads}); });
        if (report_.frames > 1) refuse_faults();  // before anything of the first frames is written
        try {
            if (has_filters(request_)) {
                filter();
            } else {
                request_.count_only ? count() : find();
            }
        } catch (const Error& error) {
            if (error.code() == ErrorCode::bad_input) refuse_faults();
            throw;
        }
    }

    /// Whether indices need more bits than a Pair has, or are to have them.
    bool wide() const { return request_.wide_indices || report_.objects > std::numeric_limits<std::uint32_t>::max(); }
    bool join() const { return !request_.against.empty(); }
    /// Whether each rank has all objects: filters and verification ask for any, and the boxes of shapes may depend on all.
    bool whole() const {
        return has_filters(request_) || request_.verify || io::is_json_file(request_.against) ||
               std::any_of(request_.inputs.begin(), request_.inputs.end(), io::is_json_file);
    }
    SliceNumber own_slice() const { return {cluster_.rank(), cluster_.ranks()}; }

    void read() {
        const Timed timed(report_.seconds.read);
        progress_.show("reading", 0);
        whole() ? inputs_.read(request_, stop_) : read_slices();
        report_.frames = inputs_.frames.frames;
        report_.moving = inputs_.frames.moving;
        report_.objects = first_.total + second_.total;
        if ((has_filters(request_) || request_.verify) && wide()) {
            throw Error(ErrorCode::resource_limit,
                        std::to_string(report_.objects) +
                            " objects: " + (request_.verify ? "--verify has" : "filters have") + " indices of 32 bits");
        }
        if (wide() && !io::is_array_file(request_.output) && !request_.count_only) {
            throw Error(ErrorCode::resource_limit,
                        std::to_string(report_.objects) + " objects: indices of 64 bits go to .npy files alone");
        }
        report_.engine = describe_engine(request_.engine);
        report_.engine.ranks = cluster_.ranks();
    }

    void read_slices() {
        const SliceRequest slice{own_slice(), cluster_.first()};
        first_ = read_input_slice(request_.inputs, {request_.mesh_objects}, slice, stop_);
        if (join()) second_ = read_input_slice({request_.against}, {request_.mesh_objects}, slice, stop_);
        inputs_.frames = joint_frames({first_.scene.frames, first_.scene.moving},
                                      {second_.scene.frames, second_.scene.moving}, request_);
        inputs_.padding.emplace(request_, SetSizes{first_.total, second_.total}, stop_);
        const auto own = [](std::span<const double> all, const InputSet& set) {
            return all.empty() ? all : all.subspan(set.begin, set.scene.objects);
        };
        first_.padding = own(inputs_.padding->inputs(), first_);
        second_.padding = own(inputs_.padding->against(), second_);
    }

    void count() {
        for (std::uint64_t frame = 0; frame < report_.frames; ++frame) report_.add(search(frame, nullptr), 0);
    }

    void find() {
        const io::PairNames names{&first_.scene.names, join() ? &second_.scene.names : &first_.scene.names};
        const auto output = make_piece_output(request_, cluster_, names, stop_, report_.moving);
        PairList piece;
        for (std::uint64_t frame = 0; frame < report_.frames; ++frame) {
            report_.add(search(frame, &piece), 0);
            progress_.clear();
            const Timed timed(report_.seconds.write);
            wide() ? output->write(frame, wide_piece_) : output->write(frame, piece);
        }
        const Timed timed(report_.seconds.write);
        output->finish();
    }

#ifdef OCTOPAIR_WITH_PIPELINE
    void filter() {
        std::unique_ptr<RankFilters> filters;
        {
            const Timed timed(report_.seconds.prepare);
            progress_.show("preparing", 0);
            filters =
                std::make_unique<RankFilters>(request_, cluster_, SetPair{first_, join() ? &second_ : nullptr}, stop_);
        }
        std::unique_ptr<FoundWriter> writer;  // the first rank's
        if (!request_.count_only) writer = make_writer();
        PairList piece;
        for (std::uint64_t frame = 0; frame < report_.frames; ++frame) {
            CollisionPiece kept;
            const Summary found = search(frame, &piece);
            PipelineSummary summary = filters->run(piece, filter_options(frame), request_.count_only ? nullptr : &kept);
            summary.search = found;
            summary.seconds += found.seconds + found.verification.seconds;
            report_.add(summary, 0);
            progress_.clear();
            if (!request_.count_only) write(frame, kept, writer.get());
        }
        if (!request_.count_only) finish(writer.get());
    }

    Options filter_options(std::uint64_t frame) {
        Options options = call_options(request_, report_, frame, progress_);
        options.progress = [&](double done) { progress_.show("filtering", done); };
        return options;
    }

    std::unique_ptr<FoundWriter> make_writer() {
        std::unique_ptr<FoundWriter> writer;
        cluster_.together([&] {
            if (!cluster_.first()) return;
            writer = make_found_writer(request_, {first_, join() ? second_ : first_, report_.moving}, stop_);
        });
        return writer;
    }

    void write(std::uint64_t frame, const CollisionPiece& piece, FoundWriter* writer) {
        const Timed timed(report_.seconds.write);
        cluster_.together([&] {
            if (writer != nullptr) writer->begin_frame(frame);
        });
        relay(cluster_, piece, writer);
        cluster_.together([&] {
            if (writer != nullptr) writer->end_frame();
        });
    }

    void finish(FoundWriter* writer) {
        const Timed timed(report_.seconds.write);
        cluster_.together([&] {
            if (writer == nullptr) return;
            writer->finish();
            report_.changes = writer->changes();
        });
    }
#else
    void filter() {}  // a program without filters refuses what needs them
#endif

    /// Of a frame, or its part that is this rank's.
    Objects own_objects(const InputSet& set, std::uint64_t frame) const {
        return whole() ? set.frame_slice(frame, own_slice()) : set.frame(frame);
    }

    /// Without a list: counts. What filters get knows no limit.
    Summary search(std::uint64_t frame, PairList* piece) {
        Summary summary = search_pieces(frame, piece);
        if (request_.verify) verify(frame, piece, summary);
        return summary;
    }

    /// The first rank checks the pairs of all ranks, which come to it some at a time. Without a list: the count.
    void verify(std::uint64_t frame, const PairList* piece, Summary& summary) {
        const FloatingPointScope scope;
        const Objects first = first_.frame(frame), second = second_.frame(frame);
        const Options options = call_options(request_, report_, frame, progress_);
        const ResultKind ordered = options.order == Order::octal ? ResultKind::octal : ResultKind::ascending;
        Verifier verifier({.objects = {first, join() ? &second : nullptr, options.margin},
                           .kind = piece != nullptr ? ordered : ResultKind::count,
                           .limit = options.limit,
                           .threads = report_.engine.threads,
                           .stop = stop_});
        if (piece != nullptr) cluster_.relay(*piece, [&](std::span<const Pair> pairs) { verifier.take(pairs); });
        cluster_.together([&] {
            if (cluster_.first()) summary.verification = verifier.finish({summary.pairs, summary.truncated});
        });
    }

    Summary search_pieces(std::uint64_t frame, PairList* piece) {
        const Input input(own_objects(first_, frame),
                          join() ? std::optional(own_objects(second_, frame)) : std::nullopt);
        Options options = call_options(request_, report_, frame, progress_);
        options.verify = false;  // ranks have slices: verify() does it
        if (has_filters(request_)) options.limit.reset();
        Summary summary;
        cluster_.joint([&] {
            if (wide()) {
                summary = find_pairs64(*engine_, unindexed(input), wide_piece_, options, stop_);
            } else if (piece == nullptr) {
                summary = engine_->stream_pairs(input, {}, options, stop_);
            } else {
                summary = engine_->find_pairs(input, *piece, options, stop_);
            }
        });
        return summary;
    }

    /// Says again what the engine found wrong with a box, with the file; of several ranks', the first one.
    void refuse_faults() {
        cluster_.together([&] {
            std::uint64_t before = 0;
            for (const InputSet* set : {&first_, &second_}) {
                if (const auto fault = set->find_fault()) throw BadObject{before + *set->fault_position(), *fault};
                before += set->total * set->scene.frames;
            }
        });
    }

    const DetectRequest& request_;
    Cluster& cluster_;
    std::stop_token stop_;
    ProgressLine progress_;
    WholeInputs inputs_;  // or slices of these
    InputSet &first_ = inputs_.first, &second_ = inputs_.second;
    std::unique_ptr<Engine> engine_;
    std::vector<Pair64> wide_piece_;
    DetectReport report_;
};

}  // namespace

DetectReport detect_on_ranks(const DetectRequest& request, Cluster& cluster, const std::stop_token& stop) {
    return RankDetection(request, cluster, stop).run();
}

}  // namespace octopair::cli
