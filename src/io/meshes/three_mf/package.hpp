// Package: a 3MF file in memory, as a package of parts (OPC), and its start part.
//
// - The names of parts do not distinguish the case of ASCII letters.
// - The relationships of the package are in the part _rels/.rels. They name the start part, which contains the model.
//
// Source: ECMA-376, part 2, Open Packaging Conventions; 3MF core specification 1.3, chapter 2.
#pragma once

#include <cstddef>
#include <functional>
#include <stop_token>
#include <string>
#include <string_view>
#include <unordered_map>

#include "base/memory.hpp"
#include "io/meshes/read_budget.hpp"
#include "io/meshes/three_mf/zip_archive.hpp"

namespace octopair::io::three_mf {

/// Passes the pieces of a text to its argument, one after another, until the argument returns false.
using TextSource = std::function<void(const std::function<bool(std::string_view)>&)>;

/// Returns the name of the part that a path names, without "/" at the beginning. Decodes %20 and the like, and removes "." and "..".
std::string part_name(std::string_view path);

/// Returns whether two names are those of the same part.
bool is_same_part(std::string_view a, std::string_view b);

class Package {
public:
    /// Throws: Error{bad_input} if the file is no ZIP archive, or is damaged; Error{io_failed, resource_limit, cancelled}.
    Package(const std::string& path, const std::stop_token& stop);
    /// Like the constructor above, with the content of the file.
    Package(std::string path, Buffer<std::byte> content, const std::stop_token& stop);

    ReadBudget& budget() { return budget_; }
    /// Returns the name of the start part. Throws: Error{bad_input} if the package does not name it.
    std::string find_start();
    /// Returns whether the package names several start parts. Requires: find_start() was called.
    bool has_several_starts() const { return starts_ > 1; }
    /// Returns the content of a part, which is unpacked while it is read. `progress` receives the part of the file that was read; or empty.
    /// Throws: Error{bad_input} if no part or several parts have this name. `place`: place that refers to the part, for messages.
    TextSource text_of(std::string_view name, std::string_view place, std::function<void(double)> progress = {});

private:
    ReadBudget budget_;
    Buffer<std::byte> content_;
    ZipArchive archive_;
    std::unordered_map<std::string, std::size_t>
        numbers_;  // name of a part in lower case -> index in the archive, or `several`
    std::size_t starts_ = 0;
    std::uint64_t packed_read_ = 0;  // packed bytes of the parts that were read
};

}  // namespace octopair::io::three_mf
