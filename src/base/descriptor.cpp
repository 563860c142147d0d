#include "base/descriptor.hpp"

#include <cerrno>
#include <string>
#include <system_error>

#include "octopair/error.hpp"

namespace octopair {

void fail_io(std::string_view file, std::string_view action, int error_number) {
    const bool memory = error_number == ENOMEM || error_number == EMFILE || error_number == ENFILE;
    throw Error(memory ? ErrorCode::resource_limit : ErrorCode::io_failed,
                std::string(file) + ": " + std::string(action) + ": " + std::generic_category().message(error_number));
}

}  // namespace octopair
