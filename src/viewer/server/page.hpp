// The page of the viewer: one file of HTML. The folder viewer/ has its sources, and the build embeds it in the library.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "viewer/server/answer.hpp"

namespace octopair::viewer {

// Made by viewer/embed.mjs: the page, compressed by gzip.
extern const std::size_t page_size;
extern const std::size_t compressed_page_size;
extern const unsigned char compressed_page_bytes[];

/// Returns the page, compressed by gzip.
inline std::string_view compressed_page() {
    return {reinterpret_cast<const char*>(compressed_page_bytes), compressed_page_size};
}
/// Returns the page. Throws: std::bad_alloc.
inline std::string page() { return gunzip(compressed_page(), page_size); }

}  // namespace octopair::viewer
