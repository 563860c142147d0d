// Defines arc4random_buf(), which expat calls and glibc has since 2.36. Only wheels have this file, because they run with glibc 2.35.
#include <cstddef>
#include <random>

extern "C" void arc4random_buf(void* buffer, std::size_t size) noexcept {
    std::random_device random;
    auto* bytes = static_cast<unsigned char*>(buffer);
    for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<unsigned char>(random());
}
