#include "base/free_memory.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>

#include "base/control_group.hpp"

namespace octopair {

namespace {

using Bound = std::optional<std::uint64_t>;

Bound lesser(Bound one, Bound other) { return one && other ? std::min(*one, *other) : one ? one : other; }

/// Returns a number of bytes from a file with lines `NAME: NUMBER kB`.
Bound kilobytes_in(const std::string& path, const std::string& name) {
    std::ifstream file(path);
    std::uint64_t number = 0;
    for (std::string word; file >> word;) {
        if (word == name + ":" && file >> number) return number * 1024;
    }
    return {};
}

/// Returns the address space that RLIMIT_AS leaves; nothing without this limit.
Bound free_address_space(const std::string& root) {
    rlimit limit{};
    if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return {};
    std::ifstream file(root + "/proc/self/statm");
    std::uint64_t pages = 0;
    if (!(file >> pages)) return {};
    return limit.rlim_cur - std::min<std::uint64_t>(limit.rlim_cur, pages * std::uint64_t(::sysconf(_SC_PAGESIZE)));
}

}  // namespace

std::optional<std::uint64_t> free_mapped_memory(const std::string& root) {
    const std::string meminfo = root + "/proc/meminfo";
    const Bound available = kilobytes_in(meminfo, "MemAvailable");
    const std::uint64_t swap = kilobytes_in(meminfo, "SwapFree").value_or(0);
    return lesser(available ? Bound(*available + swap) : Bound(), control_group_free_memory(swap, root));
}

std::optional<std::uint64_t> free_memory(const std::string& root) {
    return lesser(free_mapped_memory(root), free_address_space(root));
}

std::string digit_groups(std::uint64_t number) {
    std::string text = std::to_string(number);
    for (std::size_t at = text.size(); at > 3;) text.insert(at -= 3, 1, ',');
    return text;
}

std::string byte_text(std::uint64_t bytes) {
    constexpr std::array units = {" bytes", " KB", " MB", " GB", " TB", " PB", " EB"};
    if (bytes < 1000) return std::to_string(bytes) + units[0];
    std::size_t unit = 0;
    double amount = double(bytes);
    while (amount >= 999.5) amount /= 1000, ++unit;
    std::array<char, 16> text{};
    std::snprintf(text.data(), text.size(), "%.*f", amount < 9.995 ? 2 : amount < 99.95 ? 1 : 0, amount);
    return text.data() + std::string(units[unit]);
}

}  // namespace octopair
