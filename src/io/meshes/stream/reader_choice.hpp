// ReaderChoice: which program reads a file of another format, and within which limits.
#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace octopair::io {

struct ReaderChoice {
    std::string command = {};  ///< command of the shell that reads any file; empty: the program of the format
    std::vector<std::string> include_types = {};  ///< IFC: types that are left out otherwise, for example "IfcSpace"
    double chord =
        0;  ///< STEP, IGES: greatest distance of triangles from the true surface, in mm; 0: that of the program
    std::chrono::seconds patience{300};  ///< a program that writes nothing for so long is ended
};

}  // namespace octopair::io
