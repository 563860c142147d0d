#include "viewer/server/page.hpp"

#include "viewer/server/answer.hpp"

namespace octopair::viewer {

std::string_view compressed_page() {
    return {reinterpret_cast<const char*>(compressed_page_bytes), compressed_page_size};
}

std::string page() { return gunzip(compressed_page(), page_size); }

}  // namespace octopair::viewer
