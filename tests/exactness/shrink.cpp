#include "exactness/shrink.hpp"

#include <algorithm>
#include <sstream>

namespace octopair::test {

namespace {

using Clock = std::chrono::steady_clock;

/// The objects to leave out: [begin, begin + count).
struct Cut {
    std::size_t begin, count;
};

OwnedObjects without(const OwnedObjects& all, const Cut& cut) {
    OwnedObjects left = all;
    const auto erase = [&](auto& list) {
        if (list.empty()) return;
        const auto begin = list.begin() + std::ptrdiff_t(cut.begin);
        list.erase(begin, begin + std::ptrdiff_t(cut.count));
    };
    std::visit(erase, left.boxes);
    erase(left.padding);
    return left;
}

/// Tries to leave out parts of a set, larger parts first.
template <typename Set>
void shrink_set(Case& a_case, const Set& set_of, const Fails& fails, Clock::time_point end) {
    for (std::size_t part = set_of(a_case).view().size() / 2; part > 0; part /= 2) {
        for (std::size_t begin = 0; begin < set_of(a_case).view().size();) {
            if (Clock::now() > end) return;
            Case smaller = a_case;
            const std::size_t count = std::min(part, set_of(a_case).view().size() - begin);
            set_of(smaller) = without(set_of(a_case), {begin, count});
            if (fails(smaller)) {
                a_case = std::move(smaller);
            } else {
                begin += count;
            }
        }
    }
}

void write_set(std::ostringstream& text, const OwnedObjects& objects, const char* name) {
    const auto write = [&](const auto& boxes) {
        using Element = std::decay_t<decltype(boxes[0])>;
        text << "const std::vector<" << (std::is_same_v<Element, Box3f> ? "Box3f" : "Box3d") << "> " << name
             << " = {\n";
        for (const auto& box : boxes) {
            text << "    {{" << box.min[0] << ", " << box.min[1] << ", " << box.min[2] << "}, {" << box.max[0] << ", "
                 << box.max[1] << ", " << box.max[2] << "}},\n";
        }
        text << "};\n";
    };
    std::visit(write, objects.boxes);
    for (std::size_t i = 0; i < objects.padding.size(); ++i) {
        text << (i == 0 ? "// paddings: " : ", ") << objects.padding[i]
             << (i + 1 == objects.padding.size() ? "\n" : "");
    }
}

}  // namespace

Case shrunk(Case a_case, const Fails& fails, std::chrono::seconds patience) {
    const Clock::time_point end = Clock::now() + patience;
    shrink_set(
        a_case, [](Case& of) -> OwnedObjects& { return of.first; }, fails, end);
    if (a_case.second)
        shrink_set(
            a_case, [](Case& of) -> OwnedObjects& { return *of.second; }, fails, end);
    return a_case;
}

std::string as_test(const Case& a_case) {
    constexpr std::size_t most = 64;
    const std::size_t objects = a_case.first.view().size() + (a_case.second ? a_case.second->view().size() : 0);
    std::ostringstream text;
    text << std::hexfloat << "// " << a_case.describe() << "\n";
    if (objects > most) return text.str();
    write_set(text, a_case.first, "first");
    if (a_case.second) write_set(text, *a_case.second, "second");
    text << "const double margin = " << a_case.margin << ";\n";
    return text.str();
}

}  // namespace octopair::test
