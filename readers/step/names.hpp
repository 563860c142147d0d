// Names of parts in files of STEP and IGES.
#pragma once

#include <TDF_Label.hxx>

#include <string>

namespace octopair::reader {

/// Returns the name of a label in UTF-8; empty if it has none.
std::string name_of(const TDF_Label& label);

/// Returns a text in UTF-8. A text that is none is taken for Latin-1.
std::string utf8_of(const std::string& text);

/// Returns whether Open CASCADE made up a name: from an entry of its document, the number of an occurrence, or the kind of a shape.
bool is_made_up(const std::string& name);

/// Returns whether a name has digits alone. Names of parts may be numbers; those of occurrences are their ids if they have no other name.
bool is_number(const std::string& name);

}  // namespace octopair::reader
