// Fuzzes the parser of addresses. An accepted address, written as text, parses to the same address.
#include <cstdint>

#include "fuzz/require.hpp"
#include "service/protocol/address.hpp"

namespace {

using namespace octopair;
using fuzz::require;

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    fuzz::require_clear_errors({.codes = {ErrorCode::usage}, .one_line = false}, [&] {
        const service::Address address = service::parse_address({reinterpret_cast<const char*>(bytes), size});
        require(address.is_unix() ? address.path.size() <= 107 : !address.host.empty() && !address.port.empty());
        const service::Address again = service::parse_address(address.text());
        require(again.path == address.path && again.host == address.host && again.port == address.port);
    });
    return 0;
}
