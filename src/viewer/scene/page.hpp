// The page of the viewer: one file of HTML, viewer/bundled/page.html. The build embeds it. The folder viewer/ has its sources.
#pragma once

#include <string_view>

namespace octopair::viewer {

extern const std::string_view page;

}  // namespace octopair::viewer
