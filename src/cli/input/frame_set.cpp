#include "cli/input/frame_set.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "boxes/box_kernel.hpp"
#include "io/files/failure.hpp"
#include "io/formats/format_choice.hpp"
#include "octopair/error.hpp"

namespace octopair::cli {

namespace {

/// Copies boxes, and widens float32 to float64. Requires: float64 boxes are not copied to float32.
template <typename Real>
void copy_boxes(const Boxes& from, std::span<Box<Real>> to) {
    std::visit(
        [&](auto boxes) {
            if constexpr (std::is_same_v<decltype(boxes), std::span<const Box<Real>>>) {
                std::copy(boxes.begin(), boxes.end(), to.begin());
            } else if constexpr (std::is_same_v<Real, double>) {
                std::transform(boxes.begin(), boxes.end(), to.begin(), [](const Box3f& box) { return wide(box); });
            }
        },
        from);
}

}  // namespace

FrameSet::FrameSet(const std::vector<std::string>& paths, const io::SceneContent& content,
                   const std::stop_token& stop) {
    for (const std::string& path : paths) {
        if (io::is_json_file(path)) io::refuse(path, "--events does not support JSON scenes yet");
    }
    if (content.reader.command.empty()) open_moving(paths);
    if (!moving_.empty()) return;
    still_ = read_input_set(paths, content, stop);
    objects_ = still_.scene.objects;
    wide_ = std::holds_alternative<Buffer<Box3d>>(still_.scene.boxes);
}

void FrameSet::open_moving(const std::vector<std::string>& paths) {
    std::vector<io::FrameCount> counts;
    for (const std::string& path : paths) {
        auto file = io::open_frames(path);
        counts.push_back(file ? io::FrameCount{file->shape().frames, true} : io::FrameCount{});
        if (!file) continue;
        objects_ += file->shape().objects;
        still_.parts.push_back({path, file->shape().objects});
        wide_ |= file->wide();
        moving_.push_back({path, std::move(*file)});
    }
    io::check_frame_counts(counts, paths);
    frames_ = counts.front();
}

template <typename Real>
void FrameSet::read(std::uint64_t frame, std::span<Box<Real>> boxes, const std::stop_token& stop) const {
    if (moving_.empty()) {
        copy_boxes(still_.scene.frame(0).boxes, boxes);
        if (const auto invalid = still_.find_invalid_box()) throw Error(ErrorCode::bad_input, invalid->message);
        return;
    }
    for (const MovingPart& part : moving_) {
        const auto place = boxes.first(std::size_t(part.file.shape().objects));
        part.file.read(frame, place, stop);
        const auto fault = io::find_invalid_box(std::span<const Box<Real>>(place));
        if (fault) {
            throw Error(ErrorCode::bad_input,
                        fmt::format("{}: frame {}: object {}: {}", part.path, frame, fault->object, fault->what));
        }
        boxes = boxes.subspan(place.size());
    }
}

template void FrameSet::read(std::uint64_t, std::span<Box3f>, const std::stop_token&) const;
template void FrameSet::read(std::uint64_t, std::span<Box3d>, const std::stop_token&) const;

}  // namespace octopair::cli
