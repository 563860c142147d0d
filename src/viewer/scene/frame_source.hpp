// FrameSource: offers a scene of files, frame by frame (kind "scene" of viewer/protocol.md).
//
// - The finder searches a frame when the page requests the frame. The source keeps the last few frames.
// - The first find() comes from load(). Until it ends, the source is loading.
// - count_frames() counts the pairs of all frames in order, on a thread of the caller.
#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <mutex>
#include <stop_token>

#include "octopair/octants.hpp"
#include "viewer/scene/frame_answers.hpp"
#include "viewer/scene/source.hpp"

namespace octopair::viewer {

class FrameSource final : public Source {
public:
    static constexpr std::size_t default_most_shown = 200'000;

    /// `finder` is borrowed. `most_shown`: largest number of objects in the overview.
    FrameSource(SceneContents contents, FrameFinder& finder, std::size_t most_shown = default_most_shown);

    /// Finds the first frame. `progress` may be empty. Throws: what the finder throws.
    void load(const ProgressSink& progress);
    /// Counts the pairs of all frames. Calls `more` with the number of counted frames, at most five times a second.
    /// Throws: what the finder throws; Error{resource_limit} if the memory does not suffice. After an exception, timeline.json has the
    /// reason.
    void count_frames(const std::function<void(std::uint64_t done)>& more, const std::stop_token& stop);
    /// Returns the number of frames that are counted so far.
    std::uint64_t counted() const;
    std::uint64_t frames() const { return finder_.frames(); }
    std::uint64_t objects() const { return contents_.objects; }
    /// Number of pairs of all counted frames, or of the first frame if none is counted.
    struct PairTotal {
        std::uint64_t pairs = 0;
        bool more = false;  ///< true if there are more pairs than the finder found
    };
    /// Requires: the source is loaded.
    PairTotal pair_total() const;
    bool moving() const { return contents_.moving; }
    /// Returns all addresses of one frame, or of the whole scene, for an exported page.
    std::vector<std::string> addresses() const;
    std::vector<std::string> addresses_of(std::uint64_t frame);

    std::optional<Answer> get(const Address& address) override;
    std::vector<std::string> greeting(const std::string& path) override;
    Message live_frame(const std::string&, std::int64_t) override { return nullptr; }
    bool loading() const override { return loading_; }

    /// Sets the message of greeting() while the source loads: progress from 0 to 1.
    void set_progress(double done) { progress_ = done; }
    /// Properties of an exported page: number of its frames, and notices that the page shows.
    struct Export {
        std::uint64_t frames;
        std::vector<std::string> notices;
        bool octants = true;  ///< false: the page has no octants and no levels
    };
    void prepare_export(Export how);

private:
    struct Frame {
        std::uint64_t number = 0;
        FrameData data;
        std::vector<Pair> began, ended;
        std::optional<Octants> octants;
    };
    using FramePointer = std::shared_ptr<Frame>;

    std::optional<Answer> get_scene(std::string_view what, const Address& address);
    std::optional<Answer> answer_about(Frame& frame, std::string_view what, const Address& address);
    std::optional<Answer> octant_answer(Frame& frame, std::string_view level);
    Answer view_answer() const;
    Answer frame_answer(const Frame& frame) const;
    Answer timeline_answer() const;
    Answer shapes_answer() const;
    std::optional<Answer> shape_answer(std::uint64_t number) const;
    Answer pose_rows() const;
    template <typename T>
    Answer shown_column(const std::vector<T>& of_objects) const;
    Answer name_column() const;
    Answer detail_columns() const;
    Json class_counts(const FrameData& data) const;
    Answer level_column(Frame& frame);

    FramePointer frame(std::uint64_t number);
    FramePointer find(std::uint64_t number, const FramePointer& before);
    FramePointer count_frame(std::uint64_t number, const FramePointer& before);
    const Octants& octants(Frame& frame);
    ShownFrame shown_frame(const Frame& frame) const;

    static constexpr std::size_t kept_frames = 4;

    SceneContents contents_;
    FrameFinder& finder_;
    std::size_t most_shown_;
    ShownObjects shown_;
    Point3d origin_ = {};
    Box3d bounds_ = {};
    bool has_classes_ = false;  // true if exact tests found classes
    bool has_bounds_ = false;   // true after a frame with objects was found
    PairTotal first_pairs_;
    std::vector<Fact> first_facts_;
    std::optional<Export> export_;
    std::atomic<bool> loading_ = true;
    std::atomic<double> progress_ = 0;
    std::mutex frames_mutex_;        // guards the finder and the kept frames
    std::deque<FramePointer> kept_;  // in the order in which they were found
    struct Counts {
        std::vector<std::uint64_t> pairs, began, ended;
        bool more_pairs = false;  // true if a frame has more pairs than the finder found
        std::string fault;        // why no more frames are counted; empty: nothing has failed
    };
    mutable std::mutex counts_mutex_;
    Counts counts_;
};

}  // namespace octopair::viewer
