// The text of report_page.html, with "@DATA@" where a report's data goes (html_report.hpp).
#pragma once

#include <string_view>

namespace octopair::io {

extern const std::string_view report_page;

}  // namespace octopair::io
