// ZipWriter: a ZIP archive in memory. Equal entries give equal bytes: all entries have the date 1980-01-01.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace octopair::io {

class ZipWriter {
public:
    ZipWriter();
    ~ZipWriter();

    /// Adds a compressed entry. Throws: Error{io_failed}; std::bad_alloc.
    void add(const std::string& name, std::string_view content);
    /// Returns the archive. To be called once, after all entries. Throws: as add().
    std::string finish();

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace octopair::io
