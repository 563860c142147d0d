#include "io/meshes/xml/xml_parser.hpp"

#include <expat.h>

#include <cstdlib>
#include <new>
#include <utility>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "octopair/error.hpp"

namespace octopair::io {

namespace {

constexpr char separator = '\n';  // between a URI and a name
constexpr std::size_t least_batch = std::size_t(1) << 18, most_batch = std::size_t(1) << 28;

/// Functions that allocate memory for the strict parsers of this thread, up to a limit.
namespace limited_memory {

constexpr std::size_t most_bytes = std::size_t(1) << 30;
constexpr std::size_t head_bytes = alignof(std::max_align_t);  // a header before each block has the block's size

thread_local std::size_t used_bytes = 0;
thread_local bool refused = false;  // true if the limit refused memory to the last parser

std::size_t& size_of(void* head) { return *static_cast<std::size_t*>(head); }
void* head_of(void* block) { return static_cast<char*>(block) - head_bytes; }

/// Allocates or resizes a block, like std::realloc. Returns null if all blocks together would exceed most_bytes.
void* resize(void* block, std::size_t size) {
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

void* allocate(std::size_t size) { return resize(nullptr, size); }

void free(void* block) {
    if (block == nullptr) return;
    used_bytes -= size_of(head_of(block));
    std::free(head_of(block));
}

constexpr XML_Memory_Handling_Suite functions = {allocate, resize, free};

}  // namespace limited_memory

XML_ParserStruct* new_parser(XmlParser::Mode mode, const char* encoding) {
    constexpr char separators[2] = {separator, 0};
    limited_memory::refused = false;
    XML_ParserStruct* const parser = mode == XmlParser::Mode::strict
                                         ? XML_ParserCreate_MM(encoding, &limited_memory::functions, separators)
                                         : XML_ParserCreate(encoding);
    if (parser == nullptr) throw std::bad_alloc();
    return parser;
}

/// Reads an unknown encoding as Latin-1. Only names of objects can differ.
int read_as_latin(void*, const XML_Char*, XML_Encoding* encoding) {
    for (int i = 0; i < 256; ++i) encoding->map[i] = i;
    encoding->data = nullptr;
    encoding->convert = nullptr;
    encoding->release = nullptr;
    return XML_STATUS_OK;
}

XmlName split_name(std::string_view name) {
    const std::size_t at = name.rfind(separator);
    if (at == std::string_view::npos) return {{}, name};
    return {name.substr(0, at), name.substr(at + 1)};
}

}  // namespace

XmlTag::XmlTag(const char* name, const char* const* attributes) : name_(split_name(name)), attributes_(attributes) {}

const char* XmlTag::find(const XmlName& name) const {
    for (const char* const* at = attributes_; *at != nullptr; at += 2) {
        if (split_name(*at) == name) return at[1];
    }
    return nullptr;
}

/// Functions that expat calls. An exception may not pass through expat. So guarded() stores the exception for run(), and stops the parser.
struct XmlParser::Callbacks {
    template <typename Call>
    static void guarded(void* user, const Call& call) {
        XmlParser& self = *static_cast<XmlParser*>(user);
        if (self.thrown_) return;  // expat may make some calls after it was stopped
        ++self.events_;
        try {
            call(self);
        } catch (...) {
            self.thrown_ = std::current_exception();
            XML_StopParser(self.parser_.get(), XML_FALSE);
        }
    }

    static void begin(void* user, const char* name, const char** attributes) {
        guarded(user, [&](XmlParser& self) { self.handler_.begin(XmlTag(name, attributes)); });
    }
    static void end(void* user, const char*) {
        guarded(user, [](XmlParser& self) { self.handler_.end(); });
    }
    static void text(void* user, const char* characters, int length) {
        guarded(user, [&](XmlParser& self) { self.handler_.text({characters, std::size_t(length)}); });
    }
    static void prefix(void* user, const char* prefix, const char* uri) {
        const auto text = [](const char* characters) { return characters == nullptr ? "" : characters; };
        guarded(user, [&](XmlParser& self) { self.handler_.prefix(text(prefix), text(uri)); });
    }
    template <typename... Ignored>
    static void refuse_dtd(void* user, Ignored...) {
        guarded(user, [](XmlParser& self) {
            refuse(self.place_,
                   fmt::format("line {}: has a DTD (<!DOCTYPE>), which 3MF does not allow; remove it", self.line()));
        });
    }
};

XmlParser::XmlParser(std::string place, XmlHandler& handler, Mode mode, const char* encoding)
    : place_(std::move(place)),
      handler_(handler),
      mode_(mode),
      parser_(new_parser(mode, encoding), XML_ParserFree),
      batch_(least_batch) {
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(parser_.get(), Callbacks::begin, Callbacks::end);
    if (mode == Mode::strict) {
        XML_SetStartNamespaceDeclHandler(parser_.get(), Callbacks::prefix);
        XML_SetStartDoctypeDeclHandler(parser_.get(), &Callbacks::refuse_dtd);
    } else {
        XML_SetCharacterDataHandler(parser_.get(), Callbacks::text);
        XML_SetUnknownEncodingHandler(parser_.get(), &read_as_latin, nullptr);
    }
}

XmlParser::~XmlParser() = default;

void XmlParser::parse(std::string_view piece) {
    waiting_ += piece;
    if (waiting_.size() >= batch_) flush(false);
}

void XmlParser::finish() { flush(true); }

// If a batch cuts a token, expat scans the token again from its beginning. So batches grow while no element begins or ends in them. This
// keeps the time of all scans linear.
void XmlParser::flush(bool last) {
    events_ = 0;
    run(waiting_, last);
    waiting_.clear();
    batch_ = events_ > 0 ? least_batch : 2 * batch_;
    if (batch_ <= most_batch) return;
    throw Error(ErrorCode::resource_limit, fmt::format("{}: line {}: has {} bytes without an element; remove this text",
                                                       place_, line(), most_batch));
}

void XmlParser::parse_whole(std::string_view text) {
    constexpr std::size_t piece = std::size_t(16) << 20;
    do {
        const std::string_view part = text.substr(0, piece);
        text.remove_prefix(part.size());
        run(part, text.empty());
    } while (!text.empty());
}

void XmlParser::run(std::string_view piece, bool last) {
    const XML_Status status = XML_Parse(parser_.get(), piece.data(), int(piece.size()), last ? XML_TRUE : XML_FALSE);
    if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
    if (status != XML_STATUS_OK) refuse_text();
}

std::uint64_t XmlParser::line() const { return XML_GetCurrentLineNumber(parser_.get()); }

void XmlParser::refuse_text() const {
    const XML_Error error = XML_GetErrorCode(parser_.get());
    if (error == XML_ERROR_NO_MEMORY && mode_ == Mode::strict && limited_memory::refused) {
        throw Error(ErrorCode::resource_limit,
                    fmt::format("{}: line {}: has more names, levels or text within a tag than 1 GiB of memory takes",
                                place_, line()));
    }
    if (error == XML_ERROR_NO_MEMORY) throw std::bad_alloc();
    const std::string_view reason = XML_ErrorString(error);
    refuse(place_, mode_ == Mode::strict
                       ? fmt::format("line {}: is not well-formed XML: {}; write the file again", line(), reason)
                       : fmt::format("line {}: is not well-formed XML ({}); export the file again", line(), reason));
}

}  // namespace octopair::io
