// Memory of expat, with a limit. Without one, an archive of a few megabytes could unpack to so many names or levels that they fill the memory.
#pragma once

struct XML_ParserStruct;

namespace octopair::io::three_mf {

/// Makes a parser whose memory is limited to 1 GiB on this thread. Names are "URI SEPARATOR NAME". Then expat reports
/// XML_ERROR_NO_MEMORY. Requires: the thread that makes the parser also uses and frees it.
/// Throws: std::bad_alloc.
XML_ParserStruct* new_limited_parser(char separator);

/// Returns whether expat was refused memory on this thread, although the system has some.
bool is_xml_memory_exhausted();

}  // namespace octopair::io::three_mf
