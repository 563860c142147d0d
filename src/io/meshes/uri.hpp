// URIs in mesh files: a URI contains data (glTF), or is the name of a file or a part.
#pragma once

#include <cstddef>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>

#include "base/memory.hpp"

namespace octopair::io {

/// Returns `uri` with each %XX replaced by the byte XX. A % without two hexadecimal digits stays as it is.
std::string percent_decoded(std::string_view uri);

/// Returns the scheme of an absolute URI, for example "https". Returns nothing for the name of a file.
std::optional<std::string_view> scheme_of(std::string_view uri);

/// Data of a URI "data:TYPE,TEXT" or "data:TYPE;base64,TEXT".
struct UriData {
    std::string_view text;
    bool is_base64;
};

/// Returns the data of a URI with the scheme "data", or nothing if it has no comma.
std::optional<UriData> data_of(std::string_view uri);

/// Returns a text without its spaces and line ends.
std::string without_blanks(std::string_view text);

/// Returns the bytes of `text` in base64 or base64url, or nothing if the text is in neither. Padding at the end may be left out.
/// Throws: Error{cancelled} soon after a stop request.
std::optional<Buffer<std::byte>> decoded_base64(std::string_view text, const std::stop_token& stop);

}  // namespace octopair::io
