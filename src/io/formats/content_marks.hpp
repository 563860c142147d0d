// Recognises the content of a file by its first bytes.
//
// - A mark is unmistakable: no valid file of another format begins with it. So a file with a mark has that format, whatever its name says.
// - A file is wrapped if its content is not the model itself: compressed, a pointer of Git LFS, an HTML page. foreign_content.cpp recognises content that is
//   no model at all, such as a program, a letter, or the answer of a web server.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace octopair::io {

/// The first bytes of a file.
struct FileHead {
    std::string bytes;       ///< at most head_bytes
    std::uint64_t size = 0;  ///< size of the whole file
    std::string tail = {};   ///< last bytes of a ZIP archive, at most tail_bytes, which have its directory

    static constexpr std::size_t head_bytes = 4096, tail_bytes = 65536;
    static constexpr std::string_view zip_mark = "PK\x03\x04";
};

/// Returns the beginning of a file as text for a search: UTF-8 without byte order mark. Text in UTF-16 is narrowed to ASCII.
std::string text_of(const FileHead& head);

/// Returns the encoding that a byte order mark shows, "UTF-16" or "UTF-32", or an empty text. ASCII in UTF-16 is recognised without a mark.
std::string_view wide_encoding(std::string_view bytes);

/// Returns the first ending of the format whose mark a file has (format_table.hpp), or for formats without an ending their name. Empty:
/// no mark is known.
std::string_view marked_format(const FileHead& head);

/// Returns what a wrapped file is and what to do, for example "is compressed with gzip; ...". Empty: the file is not wrapped. A format
/// that is itself an archive, such as 3MF (ZIP), does not count as wrapped. `ending`: ending of the file's name, in lower case.
std::string wrapping_of(const FileHead& head, std::string_view ending);

/// Returns what a file without the mark of a format is, and what to do, for example "is a program, not a model; ...". Empty: the content
/// is not recognised. `ending`: ending of the file's name, in lower case.
std::string foreign_content(const FileHead& head, std::string_view ending);

/// Returns the name of the first element of an XML text, or an empty text. The end of the XML text may be missing.
std::string_view first_element(std::string_view text);

}  // namespace octopair::io
