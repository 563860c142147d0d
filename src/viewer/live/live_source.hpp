// LiveSource: offers a LiveFeed to pages.
#pragma once

#include <atomic>
#include <string>

#include "octopair/octants.hpp"
#include "viewer/live/live_feed.hpp"
#include "viewer/scene/frame_answers.hpp"
#include "viewer/scene/scene_contents.hpp"
#include "viewer/scene/source.hpp"

namespace octopair::viewer {

class LiveSource final : public Source {
public:
    /// `contents`: title, names and axes of the scene. The number of objects comes from the frames, not from `contents`.
    explicit LiveSource(SceneContents contents) : contents_(std::move(contents)) {}

    LiveFeed& feed() { return feed_; }
    /// Returns the number of pages that are connected.
    unsigned pages() const { return pages_; }
    /// Returns the number of connections that pages have made so far.
    std::uint64_t connections() const { return connections_; }

    std::optional<Answer> get(const Address& address) override;
    std::vector<std::string> greeting(const std::string&) override { return {ready_message()}; }
    Message live_frame(const std::string&, std::int64_t last) override { return feed_.frame_after(last); }
    void connected(const std::string& path, bool here) override;

private:
    Answer view_answer(const FrameData& data) const;

    const Octants& octants(const ShownFrame& frame);

    SceneContents contents_;
    LiveFeed feed_;
    Octants octants_;  // of the frame that has `octants_of_`
    std::shared_ptr<const void> octants_of_;
    std::atomic<unsigned> pages_ = 0;
    std::atomic<std::uint64_t> connections_ = 0;
};

}  // namespace octopair::viewer
