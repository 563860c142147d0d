#include "io/meshes/faces/face_cutter.hpp"

#include <algorithm>
#include <numeric>

#include "io/meshes/faces/outline_sweep.hpp"

#include <fmt/format.h>

namespace octopair::io {

namespace {

/// Cuts off ears: corners that bulge outward, with no other corner in their triangle. Without an ear, the cutter cuts off the next corner.
class EarCutter {
public:
    explicit EarCutter(const PlaneOutline& outline)
        : outline_(outline), bulge_(outline.is_counterclockwise() ? 1 : -1), left_(outline.size()) {
        std::iota(left_.begin(), left_.end(), 0u);
    }

    void run(std::vector<FaceCutter::Triangle>& triangles) {
        std::size_t at = 0, tried = 0;
        while (left_.size() > 3 && tests_ < most_tests) {
            const FaceCutter::Triangle ear = {left_[(at + left_.size() - 1) % left_.size()], left_[at],
                                              left_[(at + 1) % left_.size()]};
            if (is_ear(ear) || ++tried == left_.size()) {
                triangles.push_back(ear);
                left_.erase(left_.begin() + std::ptrdiff_t(at));
                at %= left_.size();
                tried = 0;
            } else {
                at = (at + 1) % left_.size();
            }
        }
        for (std::size_t i = 1; i + 1 < left_.size(); ++i) triangles.push_back({left_[0], left_[i], left_[i + 1]});
    }

private:
    bool is_ear(const FaceCutter::Triangle& ear) {
        ++tests_;
        const auto [before, at, after] = ear;
        if (outline_.side(before, at, after) != bulge_) return false;
        return std::none_of(
            left_.begin(), left_.end(), [&, before = before, at = at, after = after](std::uint32_t other) {
                ++tests_;
                for (const std::uint32_t corner : {before, at, after}) {
                    if (outline_.compare(corner, other) == 0) return false;
                }
                return outline_.side(before, at, other) != -bulge_ && outline_.side(at, after, other) != -bulge_ &&
                       outline_.side(after, before, other) != -bulge_;
            });
    }

    static constexpr std::uint64_t most_tests = std::uint64_t(1) << 22;  // a tenth of a second

    const PlaneOutline& outline_;
    int bulge_;
    std::vector<std::uint32_t> left_;
    std::uint64_t tests_ = 0;
};

}  // namespace

bool FaceCutter::cut(std::span<const Point3d> outline) {
    triangles_.clear();
    if (outline.size() <= 3) {
        cut_from_first_corner(outline.size());
        return true;
    }
    const PlaneOutline in_plane(outline, check_);
    if (in_plane.is_convex()) {
        cut_from_first_corner(outline.size());
        return true;
    }
    if (cut_by_sweep(in_plane, triangles_)) return true;
    EarCutter(in_plane).run(triangles_);
    return false;
}

void FaceCutter::cut_from_first_corner(std::size_t corners) {
    for (std::uint32_t i = 1; i + 1 < corners; ++i) triangles_.push_back({0, i, i + 1});
}

void CrossingFaces::add(std::uint64_t face, std::string_view object) {
    if (count_++ > 0) return;
    first_ = face;
    object_ = object;
}

void CrossingFaces::append_warning(std::string_view path, std::vector<std::string>& warnings) const {
    if (count_ == 0) return;
    const std::string_view what = count_ == 1 ? "1 face crosses itself or folds" : "faces cross themselves or fold";
    warnings.push_back(
        fmt::format("{}: {}{} (the first: face {} of '{}'); {} triangles may be wrong, so divide {} in the file", path,
                    count_ == 1 ? "" : fmt::format("{} ", count_), what, first_, object_, count_ == 1 ? "its" : "their",
                    count_ == 1 ? "it" : "them"));
}

}  // namespace octopair::io
