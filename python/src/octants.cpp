// Lists of octants as arrays, and list_octants().
#include <algorithm>
#include <cstdint>

#include "arrays.hpp"
#include "bindings.hpp"
#include "call.hpp"

namespace octopair::python {

namespace {

py::array_t<std::uint32_t> copied(std::span<const std::uint32_t> numbers) {
    py::array_t<std::uint32_t> array(py::ssize_t(numbers.size()));
    std::ranges::copy(numbers, array.mutable_data());
    return array;
}

py::tuple list_octants_of(const ArrayInput& input, double margin, unsigned threads) {
    Octants octants;
    call({input.size()}, [&](const std::stop_token& stop, auto&&...) {
        octants = list_octants(input.input().first, {margin, threads}, stop);
    });
    return octants_tuple(octants);
}

}  // namespace

py::tuple octants_tuple(const Octants& octants) {
    const auto all = octants.all();
    const auto count = py::ssize_t(all.size());
    py::list codes(all.size());
    py::array_t<double> bounds({count, py::ssize_t(6)});
    py::array_t<bool> leaf(count);
    py::array_t<std::uint64_t> entries(count), homes(count);
    py::array_t<std::int64_t> offsets(count + 1);
    offsets.mutable_data()[0] = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
        codes[i] = py::cast(all[i].code);
        std::ranges::copy(all[i].bounds.min, bounds.mutable_data() + 6 * i);
        std::ranges::copy(all[i].bounds.max, bounds.mutable_data() + 6 * i + 3);
        leaf.mutable_data()[i] = all[i].leaf;
        entries.mutable_data()[i] = all[i].entries;
        homes.mutable_data()[i] = all[i].homes;
        offsets.mutable_data()[i + 1] = offsets.data()[i] + std::int64_t(all[i].entries);
    }
    py::array_t<std::uint32_t> objects(py::ssize_t(offsets.data()[all.size()]));
    for (std::size_t i = 0; i < all.size(); ++i) {
        std::ranges::copy(octants.objects(i), objects.mutable_data() + offsets.data()[i]);
    }
    const Box3d space = octants.space();
    py::array_t<double> region(py::ssize_t(6));
    std::ranges::copy(space.min, region.mutable_data());
    std::ranges::copy(space.max, region.mutable_data() + 3);
    return py::make_tuple(codes, bounds, leaf, entries, homes, objects, offsets, copied(octants.home_octants()),
                          region);
}

void bind_octants(py::module_& module) {
    module.def("list_octants", &list_octants_of, py::arg("input"), py::arg("margin"), py::arg("threads"));
}

}  // namespace octopair::python
