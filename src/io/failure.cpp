#include "io/failure.hpp"

#include <cerrno>
#include <cmath>
#include <system_error>

#include <fmt/format.h>

#include "octopair/error.hpp"

namespace octopair::io {

void refuse(std::string_view file, std::string_view what) {
    throw Error(ErrorCode::bad_input, fmt::format("{}: {}", file, what));
}

void fail_io(std::string_view file, std::string_view action, int error_number) {
    const bool memory = error_number == ENOMEM || error_number == EMFILE || error_number == ENFILE;
    throw Error(memory ? ErrorCode::resource_limit : ErrorCode::io_failed,
                fmt::format("{}: {}: {}", file, action, std::generic_category().message(error_number)));
}

std::string number_text(float number) { return std::isnan(number) ? "nan" : fmt::format("{}", number); }
std::string number_text(double number) { return std::isnan(number) ? "nan" : fmt::format("{}", number); }

void cancel() { throw Error(ErrorCode::cancelled, "interrupted"); }

}  // namespace octopair::io
