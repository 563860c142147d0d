#include "service/server/net/role_file.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <sstream>
#include <string_view>

#include "octopair/error.hpp"
#include "service/protocol/credential_files.hpp"

namespace octopair::service {

namespace {

std::optional<Role> role_from(const std::string& name) {
    constexpr std::array<Role, 4> roles = {Role::owner, Role::reader, Role::server_operator, Role::none};
    for (const Role role : roles) {
        if (name_of(role) == name) return role;
    }
    return {};
}

/// Thrown for a line with a syntax error.
struct WrongLine {
    const char* why;
};

/// Throws: WrongLine unless `name` has the form of a client's name (access.hpp).
void check_client(std::string_view name) {
    constexpr std::array<std::string_view, 5> kinds = {
        "token:", "certificate:", "certificate-uri:", "certificate-email:", "certificate-dns:"};
    if (name == "local") return;
    const auto kind = std::ranges::find_if(kinds, [&](std::string_view one) { return name.starts_with(one); });
    if (kind == kinds.end()) {
        throw WrongLine{
            "a client is token:NAME, certificate:NAME, certificate-uri:NAME, certificate-email:NAME, "
            "certificate-dns:NAME or local, as in the server's log"};
    }
    if (name == *kind) throw WrongLine{"a name must follow the colon, without a blank between them"};
}

/// Divides a line into words (role_file.hpp). Its members throw WrongLine.
class LineReader {
public:
    explicit LineReader(std::string_view line) : rest_(line) {
        if (rest_.ends_with('\r')) rest_.remove_suffix(1);
        const auto is_control = [](char c) { return (c >= 0 && c < ' ' && c != '\t') || c == '\x7F'; };
        if (std::ranges::any_of(rest_, is_control)) throw WrongLine{"it contains a control character"};
        skip_blanks();
    }

    bool is_empty_or_comment() const { return rest_.empty() || rest_.front() == '#'; }

    /// Returns the next word, without its quotes; empty at the end of the line.
    std::string word() {
        std::string word = rest_.starts_with('"') ? quoted_word() : plain_word();
        if (!rest_.empty() && !is_blank(rest_.front())) throw WrongLine{"a blank must follow a closing quote"};
        skip_blanks();
        return word;
    }

private:
    static bool is_blank(char c) { return c == ' ' || c == '\t'; }

    void skip_blanks() {
        while (!rest_.empty() && is_blank(rest_.front())) rest_.remove_prefix(1);
    }
    char next() {
        if (rest_.empty()) throw WrongLine{"a quote is not closed"};
        const char c = rest_.front();
        rest_.remove_prefix(1);
        return c;
    }

    std::string quoted_word() {
        std::string word;
        (void)next();
        for (char c = next(); c != '"'; c = next()) {
            if (c == '\\') c = escaped();
            word += c;
        }
        if (word.empty()) throw WrongLine{"a name in quotes is empty"};
        return word;
    }

    char escaped() {
        const char c = next();
        if (c != '"' && c != '\\') throw WrongLine{"in quotes, a backslash must be written as \\\\"};
        return c;
    }

    std::string plain_word() {
        std::string word;
        for (; !rest_.empty() && !is_blank(rest_.front()); rest_.remove_prefix(1)) word += rest_.front();
        if (word.find('"') != std::string::npos)
            throw WrongLine{"a name that contains a quote must be in quotes, with \\\" for the quote"};
        return word;
    }

    std::string_view rest_;
};

}  // namespace

Roles::Roles(const std::string& path) {
    const std::string content = read_private_file(path);
    if (content.starts_with("\xEF\xBB\xBF"))
        throw Error(ErrorCode::bad_input,
                    path + ": line 1: it begins with a byte order mark; save the file without one");
    std::istringstream in(content);
    std::size_t number = 0;
    for (std::string text; std::getline(in, text);) {
        ++number;
        try {
            add_line(text);
        } catch (const WrongLine& wrong) {
            throw Error(ErrorCode::bad_input, path + ": line " + std::to_string(number) + ": " + wrong.why);
        }
    }
}

void Roles::add_line(std::string_view text) {
    LineReader line(text);
    if (line.is_empty_or_comment()) return;
    const std::string name = line.word();
    check_client(name);
    const std::optional<Role> role = role_from(line.word());
    if (!role) throw WrongLine{"a line must be CLIENT ROLE; roles are owner, reader OWNER, operator and none"};
    const std::string reads = line.word();
    if ((*role == Role::reader) == reads.empty() || !line.word().empty())
        throw WrongLine{"the role reader needs the name of one owner; other roles have none"};
    if (!reads.empty()) check_client(reads);
    if (!callers_.try_emplace(name, Caller{name, *role, reads}).second)
        throw WrongLine{"an earlier line has the same client"};
}

std::vector<std::string> Roles::clients() const {
    std::vector<std::string> names;
    names.reserve(callers_.size());
    for (const auto& [name, caller] : callers_) names.push_back(name);
    return names;
}

Caller Roles::caller(const std::string& name) const {
    const auto known = callers_.find(name);
    return known == callers_.end() ? Caller{name} : known->second;
}

}  // namespace octopair::service
