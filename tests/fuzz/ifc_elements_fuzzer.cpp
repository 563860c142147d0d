// Fuzzes the reader of the text of IFC files.
#include <cstdint>

#include "fuzz/require.hpp"
#include "io/meshes/assimp/ifc_text.hpp"

using namespace octopair;
using fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(bytes), size);
    std::size_t all = 0;
    const io::IfcText read = io::read_ifc_text(text);
    for (const auto& [id, name] : read.names) {
        require(id.size() == 22 && !name.empty());
        all += name.size();
    }
    require(all <= 2 * size && read.largest_coordinate >= 0);
    for (const auto& [id, material] : read.materials) require(id.size() == 22 && !material.empty());
    std::size_t links = 0;
    for (const auto& of_relation : read.links) {
        for (const auto& [from, to] : of_relation) require(from.size() == 22 && to.size() == 22), ++links;
    }
    require(links <= size);
    require(io::decode_step_text(text).size() <= 2 * size);
    if (const auto element = io::parse_ifc_element(text)) {
        require(element->type.size() + element->name.size() + element->id.size() <= size);
    }
    return 0;
}
