// ReaderChoice: which program reads a file of another format, and within which limits.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace octopair::io {

struct ReaderChoice {
    std::string command = {};  ///< command of the shell that reads any file; empty: the program of the format
    std::vector<std::string> include_types = {};  ///< IFC: types that are left out otherwise, for example "IfcSpace"
    /// STEP, IGES: greatest distance of triangles from the true surface, in the unit of the world; 0: that of the program.
    double chord = 0;
    std::optional<std::uint64_t> memory =
        {};                              ///< the most bytes that the program may have; by default as ReadBudget says
    std::chrono::seconds patience{300};  ///< a program that writes nothing for so long is ended
};

}  // namespace octopair::io
