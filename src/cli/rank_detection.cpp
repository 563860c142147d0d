#include "cli/rank_detection.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/timed.hpp"
#include "cli/input_set.hpp"
#include "cli/join.hpp"
#include "cli/piece_output.hpp"
#include "cli/progress_line.hpp"
#include "octopair/error.hpp"
#include "octopair/mpi.hpp"

namespace octopair::cli {

namespace {

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
        cluster_.joint([&] { engine_ = make_mpi_engine(MPI_COMM_WORLD, {.threads = report_.crew.threads}); });
        if (report_.frames > 1) refuse_faults();  // before anything of the first frames is written
        try {
            request_.count_only ? count() : find();
        } catch (const Error& error) {
            if (error.code() == ErrorCode::bad_input) refuse_faults();
            throw;
        }
    }

    /// Whether indices need more bits than a Pair has, or are to have them.
    bool wide() const { return request_.wide_indices || report_.objects > std::numeric_limits<std::uint32_t>::max(); }
    bool join() const { return !request_.against.empty(); }

    void read() {
        const Timed timed(report_.seconds.read);
        progress_.show("reading", 0);
        const SliceRequest slice{{cluster_.rank(), cluster_.ranks()}, cluster_.first()};
        first_ = read_input_slice(request_.inputs, {request_.mesh_objects}, slice, stop_);
        if (join()) second_ = read_input_slice({request_.against}, {request_.mesh_objects}, slice, stop_);
        const io::FrameCount frames = joint_frames({first_.scene.frames, first_.scene.moving},
                                                   {second_.scene.frames, second_.scene.moving}, request_);
        report_.frames = frames.frames;
        report_.moving = frames.moving;
        padding_.emplace(request_, SetSizes{first_.total, second_.total}, stop_);
        const auto own = [](std::span<const double> all, const InputSet& set) {
            return all.empty() ? all : all.subspan(set.begin, set.scene.objects);
        };
        first_.padding = own(padding_->inputs(), first_);
        second_.padding = own(padding_->against(), second_);
        report_.objects = first_.total + second_.total;
        const bool npy = !request_.output.empty() && io::pair_format(request_.output) == io::PairFormat::npy;
        if (wide() && !npy && !request_.count_only) {
            throw Error(ErrorCode::resource_limit,
                        std::to_string(report_.objects) + " objects: indices of 64 bits go to .npy files alone");
        }
        report_.crew = crew_of(request_.engine);
        report_.crew.ranks = cluster_.ranks();
    }

    void count() {
        for (std::uint64_t frame = 0; frame < report_.frames; ++frame) search(frame, nullptr);
    }

    void find() {
        const io::PairNames names{&first_.scene.names, join() ? &second_.scene.names : &first_.scene.names};
        const auto output = make_piece_output(request_, cluster_, names, stop_, report_.moving);
        PairList piece;
        for (std::uint64_t frame = 0; frame < report_.frames; ++frame) {
            search(frame, &piece);
            progress_.clear();
            const Timed timed(report_.seconds.write);
            wide() ? output->write(frame, wide_piece_) : output->write(frame, piece);
        }
        const Timed timed(report_.seconds.write);
        output->finish();
    }

    /// Without a list: counts.
    void search(std::uint64_t frame, PairList* piece) {
        const Objects first = first_.frame(frame), second = second_.frame(frame);
        const Options options = call_options(request_, report_, frame, progress_);
        Summary summary;
        cluster_.joint([&] {
            if (wide()) {
                summary = join() ? find_pairs64_between(*engine_, {first}, {second}, wide_piece_, options, stop_)
                                 : find_pairs64(*engine_, {first}, wide_piece_, options, stop_);
            } else if (piece == nullptr) {
                summary = join() ? engine_->stream_pairs_between(first, second, {}, options, stop_)
                                 : engine_->stream_pairs(first, {}, options, stop_);
            } else {
                summary = join() ? engine_->find_pairs_between(first, second, *piece, options, stop_)
                                 : engine_->find_pairs(first, *piece, options, stop_);
            }
        });
        report_.add(summary, 0);
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
    InputSet first_, second_;
    std::optional<Paddings> padding_;
    std::unique_ptr<Engine> engine_;
    std::vector<Pair64> wide_piece_;
    DetectReport report_;
};

}  // namespace

DetectReport detect_on_ranks(const DetectRequest& request, Cluster& cluster, const std::stop_token& stop) {
    return RankDetection(request, cluster, stop).run();
}

}  // namespace octopair::cli
