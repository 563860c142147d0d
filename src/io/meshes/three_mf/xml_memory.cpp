#include "io/meshes/three_mf/xml_memory.hpp"

#include <expat.h>

#include <cstddef>
#include <cstdlib>
#include <new>

namespace octopair::io::three_mf {

namespace {

constexpr std::size_t most_bytes = std::size_t(1) << 30;
constexpr std::size_t head_bytes = alignof(std::max_align_t);  // before each block: its size

thread_local std::size_t used_bytes = 0;
thread_local bool refused = false;

std::size_t& size_of(void* head) { return *static_cast<std::size_t*>(head); }
void* head_of(void* block) { return static_cast<char*>(block) - head_bytes; }

/// Frees or resizes a block, as std::realloc does. Returns null if `size` bytes are too many.
void* resize_block(void* block, std::size_t size) {
    const std::size_t before = block == nullptr ? 0 : size_of(head_of(block));
    if (size > most_bytes || used_bytes - before + size > most_bytes) {
        refused = true;
        return nullptr;
    }
    void* const head = std::realloc(block == nullptr ? nullptr : head_of(block), head_bytes + size);
    if (head == nullptr) return nullptr;
    used_bytes += size - before;
    size_of(head) = size;
    return static_cast<char*>(head) + head_bytes;
}

void* allocate_block(std::size_t size) { return resize_block(nullptr, size); }

void free_block(void* block) {
    if (block == nullptr) return;
    used_bytes -= size_of(head_of(block));
    std::free(head_of(block));
}

}  // namespace

XML_ParserStruct* new_limited_parser(char separator) {
    constexpr XML_Memory_Handling_Suite memory = {allocate_block, resize_block, free_block};
    refused = false;
    const char separators[2] = {separator, 0};
    XML_ParserStruct* const parser = XML_ParserCreate_MM(nullptr, &memory, separators);
    if (parser == nullptr) throw std::bad_alloc();
    return parser;
}

bool is_xml_memory_exhausted() { return refused; }

}  // namespace octopair::io::three_mf
