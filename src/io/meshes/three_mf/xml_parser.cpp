#include "io/meshes/three_mf/xml_parser.hpp"

#include <expat.h>

#include <new>
#include <utility>

#include <fmt/format.h>

#include "io/files/failure.hpp"
#include "io/meshes/three_mf/xml_memory.hpp"
#include "octopair/error.hpp"

namespace octopair::io::three_mf {

namespace {

constexpr char separator = '\n';  // between a URI and a name
constexpr std::size_t least_batch = std::size_t(1) << 18, most_batch = std::size_t(1) << 28;

XmlName resolved(std::string_view name) {
    const std::size_t at = name.rfind(separator);
    if (at == std::string_view::npos) return {{}, name};
    return {name.substr(0, at), name.substr(at + 1)};
}

}  // namespace

XmlElement::XmlElement(const char* name, const char* const* attributes)
    : name_(resolved(name)), attributes_(attributes) {}

const char* XmlElement::find(const XmlName& name) const {
    for (const char* const* at = attributes_; *at != nullptr; at += 2) {
        if (resolved(*at) == name) return at[1];
    }
    return nullptr;
}

/// Functions that expat calls. An exception may not pass through expat: they keep it for flush(), and stop the parser.
struct XmlParser::Callbacks {
    template <typename Call>
    static void guarded(void* user, const Call& call) {
        XmlParser& self = *static_cast<XmlParser*>(user);
        if (self.thrown_) return;  // expat may make some more calls after it was stopped
        ++self.events_;
        try {
            call(self);
        } catch (...) {
            self.thrown_ = std::current_exception();
            XML_StopParser(self.parser_.get(), XML_FALSE);
        }
    }

    static void begin(void* user, const char* name, const char** attributes) {
        guarded(user, [&](XmlParser& self) { self.handler_.begin(XmlElement(name, attributes)); });
    }
    static void end(void* user, const char*) {
        guarded(user, [](XmlParser& self) { self.handler_.end(); });
    }
    static void prefix(void* user, const char* prefix, const char* uri) {
        const auto text = [](const char* characters) { return characters == nullptr ? "" : characters; };
        guarded(user, [&](XmlParser& self) { self.handler_.prefix(text(prefix), text(uri)); });
    }
    static void doctype(void* user) {
        guarded(user, [](XmlParser& self) {
            refuse(self.place_,
                   fmt::format("line {}: has a DTD (<!DOCTYPE>), which 3MF does not allow; remove it", self.line()));
        });
    }
};

XmlParser::XmlParser(std::string place, XmlHandler& handler)
    : place_(std::move(place)),
      handler_(handler),
      parser_(new_limited_parser(separator), XML_ParserFree),
      batch_(least_batch) {
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(parser_.get(), Callbacks::begin, Callbacks::end);
    XML_SetStartNamespaceDeclHandler(parser_.get(), Callbacks::prefix);
    XML_SetStartDoctypeDeclHandler(
        parser_.get(), [](void* user, const char*, const char*, const char*, int) { Callbacks::doctype(user); });
}

XmlParser::~XmlParser() = default;

void XmlParser::parse(std::string_view piece) {
    waiting_ += piece;
    if (waiting_.size() >= batch_) flush(false);
}

void XmlParser::finish() { flush(true); }

// expat scans a token that a batch cuts from its begin again. So batches grow as long as no element begins or ends in them, and the whole
// scan takes linear time.
void XmlParser::flush(bool last) {
    events_ = 0;
    const XML_Status status =
        XML_Parse(parser_.get(), waiting_.data(), int(waiting_.size()), last ? XML_TRUE : XML_FALSE);
    if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
    if (status != XML_STATUS_OK) refuse_text();
    waiting_.clear();
    batch_ = events_ > 0 ? least_batch : 2 * batch_;
    if (batch_ <= most_batch) return;
    throw Error(ErrorCode::resource_limit, fmt::format("{}: line {}: has {} bytes without an element; remove this text",
                                                       place_, line(), most_batch));
}

std::uint64_t XmlParser::line() const { return XML_GetCurrentLineNumber(parser_.get()); }

void XmlParser::refuse_text() const {
    const XML_Error error = XML_GetErrorCode(parser_.get());
    if (error == XML_ERROR_NO_MEMORY && is_xml_memory_exhausted()) {
        throw Error(ErrorCode::resource_limit,
                    fmt::format("{}: line {}: has more names, levels or text within a tag than 1 GiB of memory takes",
                                place_, line()));
    }
    if (error == XML_ERROR_NO_MEMORY) throw std::bad_alloc();
    refuse(place_,
           fmt::format("line {}: is not well-formed XML: {}; write the file again", line(), XML_ErrorString(error)));
}

}  // namespace octopair::io::three_mf
