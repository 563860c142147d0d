#include "names.hpp"

#include <TDataStd_Name.hxx>

#include <algorithm>
#include <array>

namespace octopair::reader {

namespace {

bool is_utf8(const std::string& text) {
    for (std::size_t i = 0; i < text.size();) {
        const auto lead = static_cast<unsigned char>(text[i++]);
        std::size_t more = lead < 0x80 ? 0 : lead >= 0xC2 && lead < 0xE0 ? 1 : lead >= 0xE0 && lead < 0xF0 ? 2 : lead >= 0xF0 && lead < 0xF5 ? 3 : 4;
        if (more == 4 || i + more > text.size()) return false;
        for (; more > 0; --more) {
            if ((static_cast<unsigned char>(text[i++]) & 0xC0) != 0x80) return false;
        }
    }
    return true;
}

}  // namespace

std::string name_of(const TDF_Label& label) {
    Handle(TDataStd_Name) name;
    if (!label.FindAttribute(TDataStd_Name::GetID(), name)) return {};
    const TCollection_ExtendedString& text = name->Get();
    std::string utf8(std::size_t(text.LengthOfCString()) + 1, '\0');
    Standard_PCharacter end = utf8.data();
    utf8.resize(std::size_t(text.ToUTF8CString(end)));
    return utf8_of(utf8);
}

std::string utf8_of(const std::string& text) {
    if (is_utf8(text)) return text;
    std::string utf8;
    for (const char letter : text) {
        const auto code = static_cast<unsigned char>(letter);
        if (code < 0x80) {
            utf8 += letter;
        } else {
            utf8 += char(0xC0 | code >> 6);
            utf8 += char(0x80 | (code & 0x3F));
        }
    }
    return utf8;
}

bool is_made_up(const std::string& name) {
    constexpr std::array<const char*, 9> kinds = {"", "COMPOUND", "COMPSOLID", "SOLID", "SHELL", "FACE", "WIRE", "EDGE", "VERTEX"};
    return name.starts_with("=>") || name.starts_with("NAUO") ||
           std::any_of(kinds.begin(), kinds.end(), [&](const char* kind) { return name == kind; });
}

bool is_number(const std::string& name) { return name.find_first_not_of("0123456789") == std::string::npos; }

}  // namespace octopair::reader
