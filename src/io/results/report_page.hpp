// The page of the folder report_page, with its style and its scripts. HtmlReport replaces the mark "@DATA@" with the data of a report (html_report.hpp).
#pragma once

#include <string_view>

namespace octopair::io {

extern const std::string_view report_page;

}  // namespace octopair::io
