// Fuzzes what the server of a page reads from a request: the address, and the parameters of tables and regions.
#include <cmath>
#include <cstdint>

#include "fuzz/require.hpp"
#include "viewer/scene/frame_answers.hpp"

namespace {

using namespace octopair;
using fuzz::require;

/// Runs a parser, which may refuse its input as bad.
template <typename Parse>
void try_to(const Parse& parse) {
    fuzz::require_clear_errors({.one_line = false}, [&] { parse(); });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    const auto address = viewer::Address::parse({reinterpret_cast<const char*>(bytes), size});
    if (!address) return 0;
    require(address->path().size() < size);
    require(address->path().find('\0') == std::string::npos);
    for (const std::string_view part : address->parts()) require(part != "." && part != "..");
    try_to([&] { require(viewer::row_request(*address).count <= viewer::max_rows); });
    try_to([&] {
        const Box3d region = viewer::region_of(*address);
        for (int i = 0; i < 3; ++i) require(std::isfinite(region.min[i]) && std::isfinite(region.max[i]));
    });
    return 0;
}
