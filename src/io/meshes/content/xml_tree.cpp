#include "io/meshes/content/xml_tree.hpp"

#include <expat.h>

#include <algorithm>
#include <map>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "io/files/failure.hpp"

namespace octopair::io {

namespace {

constexpr std::size_t no_parent = std::size_t(-1), max_depth = 5000;

/// Reads an unknown encoding as Latin-1. Only names of objects can differ.
int read_as_latin(void*, const XML_Char*, XML_Encoding* encoding) {
    for (int i = 0; i < 256; ++i) encoding->map[i] = i;
    encoding->data = nullptr;
    encoding->convert = nullptr;
    encoding->release = nullptr;
    return XML_STATUS_OK;
}

}  // namespace

/// Fills a tree with what expat reports.
class XmlTreeBuilder {
public:
    /// `encoding`: name of an encoding to use in place of the declared one, or null.
    XmlTreeBuilder(XmlTree& tree, const char* encoding)
        : tree_(tree), parser_(XML_ParserCreate(encoding), &XML_ParserFree) {
        XML_SetUserData(parser_.get(), this);
        XML_SetElementHandler(parser_.get(), &XmlTreeBuilder::begin, &XmlTreeBuilder::end);
        XML_SetCharacterDataHandler(parser_.get(), &XmlTreeBuilder::add_text);
        XML_SetUnknownEncodingHandler(parser_.get(), &read_as_latin, nullptr);
    }

    /// Returns what is wrong with the text, with its line; empty if nothing.
    std::string parse(std::string_view bytes) {
        constexpr std::size_t piece = std::size_t(16) << 20;
        do {
            const std::string_view part = bytes.substr(0, piece);
            bytes.remove_prefix(part.size());
            const auto status = XML_Parse(parser_.get(), part.data(), int(part.size()), bytes.empty() ? 1 : 0);
            if (too_deep_) return fmt::format("line {}: more than {} elements are nested", line(), max_depth);
            if (status != XML_STATUS_OK) {
                return fmt::format("line {}: is not well-formed XML ({}); export the file again", line(),
                                   XML_ErrorString(XML_GetErrorCode(parser_.get())));
            }
        } while (!bytes.empty());
        return {};
    }

private:
    std::size_t line() const { return std::size_t(XML_GetCurrentLineNumber(parser_.get())); }

    std::uint32_t number_of(const XML_Char* name) {
        const auto [found, is_new] = numbers_.try_emplace(name, std::uint32_t(tree_.names_.size()));
        if (is_new) tree_.names_.push_back(found->first);
        return found->second;
    }

    static void begin(void* self, const XML_Char* name, const XML_Char** attributes) {
        static_cast<XmlTreeBuilder*>(self)->begin_element(name, attributes);
    }
    static void end(void* self, const XML_Char*) { static_cast<XmlTreeBuilder*>(self)->end_element(); }
    static void add_text(void* self, const XML_Char* text, int length) {
        static_cast<XmlTreeBuilder*>(self)->append(std::string_view(text, std::size_t(length)));
    }

    void begin_element(const XML_Char* name, const XML_Char** attributes) {
        XmlTree::Element element;
        element.name = number_of(name);
        element.line = line();
        element.parent = open_.empty() ? no_parent : open_.back();
        element.first_attribute = tree_.attributes_.size();
        for (; *attributes != nullptr; attributes += 2) {
            XmlTree::Attribute attribute;
            attribute.name = number_of(attributes[0]);
            attribute.begin = tree_.characters_.size();
            tree_.characters_ += attributes[1];
            attribute.end = tree_.characters_.size();
            tree_.attributes_.push_back(attribute);
            ++element.attributes;
        }
        element.text_begin = element.text_end = tree_.characters_.size();
        open_.push_back(tree_.elements_.size());
        tree_.elements_.push_back(element);
        has_child_ = false;
        if (open_.size() <= max_depth) return;
        too_deep_ = true;
        XML_StopParser(parser_.get(), XML_FALSE);
    }

    void end_element() {
        tree_.elements_[open_.back()].end = tree_.elements_.size();
        open_.pop_back();
        has_child_ = true;
    }

    void append(std::string_view text) {
        if (open_.empty() || has_child_) return;
        tree_.characters_ += text;
        tree_.elements_[open_.back()].text_end = tree_.characters_.size();
    }

    XmlTree& tree_;
    std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser_;
    std::map<std::string, std::uint32_t, std::less<>> numbers_;
    std::vector<std::size_t> open_;
    bool has_child_ = false;  // the last open element has a child
    bool too_deep_ = false;
};

XmlTree::XmlTree(std::string path, std::string_view bytes) : path_(std::move(path)) {
    std::string fault = XmlTreeBuilder(*this, nullptr).parse(bytes);
    if (fault.empty()) return;
    // Some programs write names in the encoding of the system, and declare UTF-8.
    XmlTree latin;
    latin.path_ = path_;
    if (!XmlTreeBuilder(latin, "ISO-8859-1").parse(bytes).empty()) io::refuse(path_, fault);
    *this = std::move(latin);
}

std::string_view XmlElement::name() const { return tree_->names_[tree_->elements_[index_].name]; }

std::size_t XmlElement::line() const { return tree_->elements_[index_].line; }

std::optional<std::string_view> XmlElement::attribute(std::string_view name) const {
    for (const auto& [key, value] : attributes()) {
        if (key == name) return value;
    }
    return std::nullopt;
}

std::vector<std::pair<std::string_view, std::string_view>> XmlElement::attributes() const {
    const XmlTree::Element& element = tree_->elements_[index_];
    std::vector<std::pair<std::string_view, std::string_view>> result;
    for (std::uint32_t i = 0; i < element.attributes; ++i) {
        const XmlTree::Attribute& attribute = tree_->attributes_[element.first_attribute + i];
        result.emplace_back(tree_->names_[attribute.name], tree_->characters(attribute.begin, attribute.end));
    }
    return result;
}

std::string_view XmlElement::text() const {
    const XmlTree::Element& element = tree_->elements_[index_];
    return tree_->characters(element.text_begin, element.text_end);
}

std::vector<XmlElement> XmlElement::children() const {
    std::vector<XmlElement> result;
    const std::size_t end = tree_->elements_[index_].end;
    for (std::size_t i = index_ + 1; i < end; i = tree_->elements_[i].end) result.emplace_back(*tree_, i);
    return result;
}

std::vector<XmlElement> XmlElement::children(std::string_view name) const {
    std::vector<XmlElement> result = children();
    std::erase_if(result, [&](const XmlElement& child) { return child.name() != name; });
    return result;
}

std::optional<XmlElement> XmlElement::child(std::string_view name) const {
    const std::size_t end = tree_->elements_[index_].end;
    for (std::size_t i = index_ + 1; i < end; i = tree_->elements_[i].end) {
        if (tree_->at(i).name() == name) return tree_->at(i);
    }
    return std::nullopt;
}

std::optional<XmlElement> XmlElement::parent() const {
    const std::size_t parent = tree_->elements_[index_].parent;
    if (parent == no_parent) return std::nullopt;
    return tree_->at(parent);
}

bool XmlElement::contains(std::string_view name) const {
    for (std::size_t i = index_ + 1; i < tree_->elements_[index_].end; ++i) {
        if (tree_->at(i).name() == name) return true;
    }
    return false;
}

void XmlElement::refuse(std::string_view what) const {
    io::refuse(tree_->path(), fmt::format("line {}: {}", line(), what));
}

}  // namespace octopair::io
