#include "cli/ranks/facts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string_view>

#include "octopair/error.hpp"

namespace octopair::cli {

namespace {

const Fact* find_fact(const Facts& facts, std::string_view what) {
    const auto found = std::find_if(facts.begin(), facts.end(), [&](const Fact& fact) { return fact.what == what; });
    return found == facts.end() ? nullptr : &*found;
}

std::string shown(const Fact* fact) {
    if (fact == nullptr) return "not given";
    return fact->where.empty() ? fact->value : fmt::format("{} ({})", fact->value, fact->where);
}

void check_same(const Facts& first, const Facts& other, std::size_t rank) {
    const auto check = [&](const Fact& fact) {
        const Fact* const a = find_fact(first, fact.what);
        const Fact* const b = find_fact(other, fact.what);
        if (a != nullptr && b != nullptr && a->value == b->value) return;
        throw Error(ErrorCode::usage,
                    fmt::format("ranks 0 and {} differ in {}: {}, {}", rank, fact.what, shown(a), shown(b)));
    };
    for (const Fact& fact : first) check(fact);
    for (const Fact& fact : other) check(fact);
}

}  // namespace

void check_facts_agree(const std::vector<Facts>& of_ranks) {
    for (std::size_t rank = 1; rank < of_ranks.size(); ++rank) check_same(of_ranks[0], of_ranks[rank], rank);
}

std::string packed(const Facts& facts) {
    std::string bytes;
    for (const Fact& fact : facts) {
        for (const std::string* text : {&fact.what, &fact.value, &fact.where}) bytes += *text + '\0';
    }
    return bytes;
}

Facts unpacked(const std::string& bytes) {
    Facts facts;
    std::size_t at = 0;
    const auto next = [&] {
        const std::size_t end = bytes.find('\0', at);
        std::string text = bytes.substr(at, end - at);
        at = end + 1;
        return text;
    };
    while (at < bytes.size()) {
        Fact fact{next(), next(), next()};
        facts.push_back(std::move(fact));
    }
    return facts;
}

}  // namespace octopair::cli
