// Traits of a scene's objects from columns. Shared by the modules with scenes.
#include <algorithm>

#include "scenes.hpp"

namespace octopair::python {

std::vector<Traits> traits_of(const py::object& groups, const py::object& masks, const py::object& fixed) {
    const auto group_column = optional_rows_of<std::uint32_t>(groups);
    const auto mask_column = optional_rows_of<std::uint32_t>(masks);
    const auto fixed_column = optional_rows_of<bool>(fixed);
    const std::size_t size = std::max({group_column.size(), mask_column.size(), fixed_column.size()});
    std::vector<Traits> traits(size);
    for (std::size_t i = 0; i < size; ++i) {
        if (!group_column.empty()) traits[i].groups = group_column[i];
        if (!mask_column.empty()) traits[i].mask = mask_column[i];
        if (!fixed_column.empty()) traits[i].fixed = fixed_column[i];
    }
    return traits;
}

}  // namespace octopair::python
