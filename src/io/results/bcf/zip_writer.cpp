#include "io/results/bcf/zip_writer.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

#include <minizip/zip.h>

#include "octopair/error.hpp"

namespace octopair::io {

namespace {

/// A file in memory, for the callbacks of minizip.
struct MemoryFile {
    std::string content = {};
    std::size_t position = 0;
    bool failed = false;  ///< memory ran out
};

MemoryFile& file_of(voidpf stream) { return *static_cast<MemoryFile*>(stream); }

voidpf open_file(voidpf file, const void*, int) { return file; }

uLong read_file(voidpf, voidpf stream, void* to, uLong bytes) {
    MemoryFile& file = file_of(stream);
    const std::size_t count = std::min<std::size_t>(bytes, file.content.size() - file.position);
    std::copy_n(file.content.data() + file.position, count, static_cast<char*>(to));
    file.position += count;
    return uLong(count);
}

uLong write_file(voidpf, voidpf stream, const void* from, uLong bytes) {
    MemoryFile& file = file_of(stream);
    try {
        file.content.resize(std::max(file.content.size(), file.position + bytes));
    } catch (const std::bad_alloc&) {  // no exception may pass through minizip
        file.failed = true;
        return 0;
    }
    std::copy_n(static_cast<const char*>(from), bytes, file.content.data() + file.position);
    file.position += bytes;
    return bytes;
}

ZPOS64_T tell(voidpf, voidpf stream) { return file_of(stream).position; }

long seek(voidpf, voidpf stream, ZPOS64_T offset, int origin) {
    MemoryFile& file = file_of(stream);
    const std::size_t base = origin == ZLIB_FILEFUNC_SEEK_CUR   ? file.position
                             : origin == ZLIB_FILEFUNC_SEEK_END ? file.content.size()
                                                                : 0;
    file.position = base + std::size_t(offset);
    return 0;
}

int close_file(voidpf, voidpf) { return 0; }
int error_of_file(voidpf, voidpf stream) { return file_of(stream).failed ? 1 : 0; }

}  // namespace

struct ZipWriter::State {
    State() {
        zlib_filefunc64_def functions = {open_file, read_file,  write_file,    tell,
                                         seek,      close_file, error_of_file, &file};
        zip = zipOpen2_64("", APPEND_STATUS_CREATE, nullptr, &functions);
        if (zip == nullptr) throw std::bad_alloc();
    }
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() {
        if (zip != nullptr) (void)zipClose(zip, nullptr);
    }

    void require(int result) const {
        if (file.failed) throw std::bad_alloc();
        if (result != ZIP_OK) throw Error(ErrorCode::io_failed, "cannot make a ZIP archive");
    }

    MemoryFile file;
    zipFile zip = nullptr;
};

ZipWriter::ZipWriter() : state_(std::make_unique<State>()) {}
ZipWriter::~ZipWriter() = default;

void ZipWriter::add(const std::string& name, std::string_view content) {
    if (content.size() > std::numeric_limits<unsigned>::max())
        throw Error(ErrorCode::resource_limit, "an entry of a ZIP archive has more than 4 GiB");
    zip_fileinfo info = {};
    info.dosDate = 1U << 21 | 1U << 16;  // month 1, day 1 of 1980, 00:00: the earliest date of the format
    state_->require(zipOpenNewFileInZip64(state_->zip, name.c_str(), &info, nullptr, 0, nullptr, 0, nullptr, Z_DEFLATED,
                                          Z_DEFAULT_COMPRESSION, 0));
    state_->require(zipWriteInFileInZip(state_->zip, content.data(), unsigned(content.size())));
    state_->require(zipCloseFileInZip(state_->zip));
}

std::string ZipWriter::finish() {
    state_->require(zipClose(std::exchange(state_->zip, nullptr), nullptr));
    return std::move(state_->file.content);
}

}  // namespace octopair::io
