// Document: what Open CASCADE reads from a file of STEP or IGES.
#pragma once

#include <TDocStd_Document.hxx>

#include <string>
#include <vector>

#include "pieces.hpp"
#include "stream_writer.hpp"

namespace octopair::reader {

struct Document {
    Handle(TDocStd_Document) content;  ///< lengths are mm
    ShapeNames names;                  ///< IGES: of the shapes inside of parts
    LostCounts lost;                   ///< solids and faces of the file that Open CASCADE cannot read
    std::vector<std::string> warnings;  ///< what it finds missing or wrong in the file, or does not read
};

/// Reads a file; its content decides its format. Throws std::runtime_error if the file has nothing that can be read.
Document read_document(const std::string& file);

}  // namespace octopair::reader
