#include "io/meshes/faces/crossing_faces.hpp"

#include <fmt/format.h>

namespace octopair::io {

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
