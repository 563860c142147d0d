// CrossingFaces: counts the faces of a file that cross themselves, for a warning.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace octopair::io {

class CrossingFaces {
public:
    /// Counts face `face` of an object.
    void add(std::uint64_t face, std::string_view object);
    /// Appends a warning about the faces of the file, if there are any.
    void append_warning(std::string_view path, std::vector<std::string>& warnings) const;

private:
    std::uint64_t count_ = 0, first_ = 0;
    std::string object_;
};

}  // namespace octopair::io
