#include "cli/output/piece_output.hpp"

#include <array>
#include <functional>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/detect/pipeline_options.hpp"
#include "io/boxes/npy_header.hpp"
#include "io/files/atomic_file.hpp"
#include "io/formats/format_choice.hpp"
#include "io/results/pair_writer.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

namespace {

/// The first rank creates an .npy file, and every rank writes its piece at its place in this file. So all hosts must share the folder.
class SharedNpy final : public PieceOutput {
public:
    SharedNpy(Cluster& cluster, std::string path, bool moving)
        : cluster_(cluster), path_(std::move(path)), moving_(moving) {
        if (!moving_) open(path_);  // so that an unwritable path fails before the search
    }

    void write(std::uint64_t frame, const PairList& piece) override {
        write_piece(frame, io::NpyType::uint32, piece.size(), piece.chunks());
    }
    void write(std::uint64_t frame, std::span<const Pair64> piece) override {
        write_piece(frame, io::NpyType::uint64, piece.size(), std::span<const std::span<const Pair64>>(&piece, 1));
    }
    void write(std::uint64_t, const CollisionPiece&) override {}  // never called: RelayedOutput writes collisions
    void finish(bool) override {}

private:
    // NOLINTNEXTLINE(readability-function-size): frame, data, number and place are one concept here.
    template <typename AnyPair>
    void write_piece(std::uint64_t frame, io::NpyType type, std::uint64_t pairs,
                     std::span<const std::span<const AnyPair>> chunks) {
        if (moving_) open(io::frame_path(path_, frame));
        const std::vector<std::uint64_t> sizes = cluster_.all_gather(pairs);
        const std::uint64_t all = std::accumulate(sizes.begin(), sizes.end(), std::uint64_t(0));
        const std::uint64_t before = std::accumulate(sizes.begin(), sizes.begin() + cluster_.rank(), std::uint64_t(0));
        const std::string header = io::make_npy_header(type, std::array<std::uint64_t, 2>{all, 2});
        cluster_.together([&] {
            if (file_) file_->write(header);
            std::uint64_t at = header.size() + before * sizeof(AnyPair);
            for (const auto chunk : chunks) {
                if (file_) file_->write(std::as_bytes(chunk));
                if (part_) part_->write_at(std::exchange(at, at + chunk.size_bytes()), std::as_bytes(chunk));
            }
            if (part_) part_->sync();
        });
        cluster_.together([&] {
            if (file_) file_->commit();
            part_.reset();
            file_.reset();
        });
    }
    void open(const std::string& path) {
        std::string temporary;
        cluster_.together([&] {
            if (!cluster_.first()) return;
            file_.emplace(path, io::AtomicFile::Shared{});
            temporary = file_->temporary();
        });
        temporary = cluster_.broadcast_text(temporary);
        cluster_.together([&] {
            if (!cluster_.first()) part_.emplace(temporary, path);
        });
    }

    Cluster& cluster_;
    std::string path_;
    bool moving_;
    std::optional<io::AtomicFile> file_;  // the whole file; only on the first rank
    std::optional<io::FilePart> part_;    // part of the first rank's file; only on the other ranks
};

/// The first rank writes the pieces of all ranks.
class RelayedOutput final : public PieceOutput {
public:
    /// `writer`: null except on the first rank.
    RelayedOutput(Cluster& cluster, std::unique_ptr<FoundWriter> writer)
        : cluster_(cluster), writer_(std::move(writer)) {}

    void write(std::uint64_t frame, const PairList& piece) override {
        write_frame(frame,
                    [&] { cluster_.relay(piece, [&](std::span<const Pair> pairs) { writer_->write(pairs, {}); }); });
    }
    void write(std::uint64_t, std::span<const Pair64>) override {
        throw Error(ErrorCode::usage, "indices of 64 bits go to .npy files alone");
    }
    void write(std::uint64_t frame, const CollisionPiece& piece) override {
        write_frame(frame, [&] { relay_collisions(piece); });
    }
    void leave_out(std::span<const Pair> pairs) override { relay_left_out(pairs); }
    void finish(bool complete) override {
        cluster_.together([&] {
            if (writer_) writer_->finish(complete);
        });
    }
    std::optional<io::StatusCounts> statuses() const override { return writer_ ? writer_->statuses() : std::nullopt; }
    std::optional<io::ChangeCounts> changes() const override { return writer_ ? writer_->changes() : std::nullopt; }

private:
    void write_frame(std::uint64_t frame, const std::function<void()>& write_all) {
        cluster_.together([&] {
            if (writer_) writer_->begin_frame(frame);
        });
        write_all();
        cluster_.together([&] {
            if (writer_) writer_->end_frame();
        });
    }
#ifdef OCTOPAIR_WITH_PIPELINE
    void relay_collisions(const CollisionPiece& piece) {
        relay(cluster_, piece, [this](auto pairs, auto findings) { writer_->write(pairs, findings); });
    }
    void relay_left_out(std::span<const Pair> pairs) {
        CollisionPiece piece;
        piece.add(pairs, {});
        relay(cluster_, piece, [this](auto left_out, auto) { writer_->leave_out(left_out); });
    }
#else
    void relay_collisions(const CollisionPiece&) {}  // a build without filters has no collisions
    void relay_left_out(std::span<const Pair>) {}
#endif

    Cluster& cluster_;
    std::unique_ptr<FoundWriter> writer_;
};

}  // namespace

std::unique_ptr<PieceOutput> make_piece_output(const DetectRequest& request, Cluster& cluster, const FoundIn& sets,
                                               const std::stop_token& stop) {
    if (io::is_array_file(request.output) && !has_filters(request)) {
        return std::make_unique<SharedNpy>(cluster, request.output, sets.moving);
    }
    std::unique_ptr<FoundWriter> writer;
    cluster.together([&] {
        if (cluster.first()) writer = make_found_writer(request, sets, stop);
    });
    return std::make_unique<RelayedOutput>(cluster, std::move(writer));
}

}  // namespace octopair::cli
