// Changes a file just before a certain system call of a program on this file. So a test chooses a moment of the run, and needs no clock.
//
// A program loads this library by LD_PRELOAD. It counts the calls of the program, and of its child processes, that open the file, ask for
// its size or its times, read or map it. Environment:
//
//   CHANGE_FILE      absolute path of the file
//   CHANGE_COUNTER   file with the number of calls (64 bits), shared by all processes; at least 8 bytes
//   CHANGE_AT        number of the call before which the file changes; the first is 1
//   CHANGE_BY        "truncate SIZE", "write OFFSET PATH" (the bytes of PATH) or "rename PATH" (PATH takes the name of the file)
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <climits>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

/// Returns the function of the C library that the function of this name here stands before.
template <typename Function>
Function next(const char* name) {
    return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

int plain_open(const char* path, int flags) {
    static const auto call = next<int (*)(const char*, int, ...)>("open");
    return call(path, flags);
}

ssize_t plain_read(int file, void* bytes, std::size_t size) {
    static const auto call = next<ssize_t (*)(int, void*, std::size_t)>("read");
    return call(file, bytes, size);
}

struct Settings {
    const char* file = std::getenv("CHANGE_FILE");
    const char* by = std::getenv("CHANGE_BY");
    std::uint64_t at = std::strtoull(std::getenv("CHANGE_AT"), nullptr, 10);
    std::atomic<std::uint64_t>* calls = nullptr;

    Settings() {
        const int counter = plain_open(std::getenv("CHANGE_COUNTER"), O_RDWR | O_CLOEXEC);
        static const auto map = next<void* (*)(void*, std::size_t, int, int, int, off_t)>("mmap");
        void* const memory = map(nullptr, sizeof(std::uint64_t), PROT_READ | PROT_WRITE, MAP_SHARED, counter, 0);
        if (memory == MAP_FAILED) std::abort();
        ::close(counter);
        calls = static_cast<std::atomic<std::uint64_t>*>(memory);
    }
};

Settings& settings() {
    static Settings settings;
    return settings;
}

void change() {
    const char* const file = settings().file;
    const char* const by = settings().by;
    char path[PATH_MAX];
    long long number = 0;
    bool done = false;
    if (std::sscanf(by, "truncate %lld", &number) == 1) {
        done = ::truncate(file, number) == 0;
    } else if (std::sscanf(by, "rename %4095[^\n]", path) == 1) {
        done = ::rename(path, file) == 0;
    } else if (std::sscanf(by, "write %lld %4095[^\n]", &number, path) == 2) {
        static char bytes[1 << 16];
        const int from = plain_open(path, O_RDONLY | O_CLOEXEC), to = plain_open(file, O_WRONLY | O_CLOEXEC);
        const ssize_t size = plain_read(from, bytes, sizeof bytes);
        done = size >= 0 && ::pwrite(to, bytes, std::size_t(size), number) == size;
        ::close(from);
        ::close(to);
    }
    if (!done) std::abort();
}

void count_call() {
    if (++*settings().calls == settings().at) change();
}

/// The program runs in the folder of the file, and may name the file alone.
void count_path(const char* path) {
    const char* const file = settings().file;
    if (std::strcmp(path, file) == 0 || std::strcmp(path, std::strrchr(file, '/') + 1) == 0) count_call();
}

void count_descriptor(int file) {
    char link[64], path[PATH_MAX];
    std::snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    const ssize_t size = ::readlink(link, path, sizeof path - 1);
    if (size <= 0) return;
    path[size] = '\0';
    if (std::strcmp(path, settings().file) == 0) count_call();
}

}  // namespace

extern "C" {

#define OPENS(name)                                            \
    int name(const char* path, int flags, ...) {               \
        static const auto call = next<decltype(&name)>(#name); \
        mode_t mode = 0;                                       \
        if ((flags & O_CREAT) != 0) {                          \
            va_list list;                                      \
            va_start(list, flags);                             \
            mode = va_arg(list, mode_t);                       \
            va_end(list);                                      \
        } else {                                               \
            count_path(path);                                  \
        }                                                      \
        return call(path, flags, mode);                        \
    }
OPENS(open)
OPENS(open64)

#define OPENS_STREAM(name)                                     \
    FILE* name(const char* path, const char* mode) {           \
        static const auto call = next<decltype(&name)>(#name); \
        count_path(path);                                      \
        return call(path, mode);                               \
    }
OPENS_STREAM(fopen)
OPENS_STREAM(fopen64)

int stat(const char* path, struct stat* status) noexcept {
    static const auto call = next<decltype(&::stat)>("stat");
    count_path(path);
    return call(path, status);
}
int stat64(const char* path, struct stat64* status) noexcept {
    static const auto call = next<decltype(&::stat64)>("stat64");
    count_path(path);
    return call(path, status);
}
int fstat(int file, struct stat* status) noexcept {
    static const auto call = next<decltype(&::fstat)>("fstat");
    count_descriptor(file);
    return call(file, status);
}
int fstat64(int file, struct stat64* status) noexcept {
    static const auto call = next<decltype(&::fstat64)>("fstat64");
    count_descriptor(file);
    return call(file, status);
}

ssize_t read(int file, void* bytes, std::size_t size) {
    count_descriptor(file);
    return plain_read(file, bytes, size);
}
ssize_t pread(int file, void* bytes, std::size_t size, off_t offset) {
    static const auto call = next<decltype(&::pread)>("pread");
    count_descriptor(file);
    return call(file, bytes, size, offset);
}
ssize_t pread64(int file, void* bytes, std::size_t size, off64_t offset) {
    static const auto call = next<decltype(&::pread64)>("pread64");
    count_descriptor(file);
    return call(file, bytes, size, offset);
}
std::size_t fread(void* bytes, std::size_t size, std::size_t count, FILE* stream) {
    static const auto call = next<decltype(&::fread)>("fread");
    count_descriptor(::fileno(stream));
    return call(bytes, size, count, stream);
}
void* mmap(void* place, std::size_t size, int protection, int flags, int file, off_t offset) noexcept {
    static const auto call = next<decltype(&::mmap)>("mmap");
    if (file >= 0) count_descriptor(file);
    return call(place, size, protection, flags, file, offset);
}

}  // extern "C"
