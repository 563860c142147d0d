// The page of the viewer: one file of HTML. The folder viewer/ has its sources, and the build embeds it in the library.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace octopair::viewer {

// Made by viewer/embed.mjs: the page, compressed by gzip.
extern const std::size_t page_size;
extern const std::size_t compressed_page_size;
extern const unsigned char compressed_page_bytes[];

/// Returns the page, compressed by gzip.
std::string_view compressed_page();
/// Returns the page. Throws: std::bad_alloc.
std::string page();

}  // namespace octopair::viewer
