// Tests the progress bar on a pseudo-terminal that is standard error.
#include "cli/command/progress_line.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include "base/descriptor.hpp"
#include "support/errors.hpp"

namespace octopair::test {
namespace {

/// Makes standard error a terminal until destruction.
class ErrorTerminal {
public:
    ErrorTerminal() : terminal_(::posix_openpt(O_RDWR | O_NOCTTY)), before_(::dup(STDERR_FILENO)) {
        EXPECT_EQ(::grantpt(terminal_.number()), 0);
        EXPECT_EQ(::unlockpt(terminal_.number()), 0);
        const Descriptor end(::open(::ptsname(terminal_.number()), O_RDWR | O_NOCTTY));
        EXPECT_EQ(::dup2(end.number(), STDERR_FILENO), STDERR_FILENO);
    }
    ~ErrorTerminal() { (void)::dup2(before_.number(), STDERR_FILENO); }
    ErrorTerminal(const ErrorTerminal&) = delete;
    ErrorTerminal& operator=(const ErrorTerminal&) = delete;

    /// Returns the text up to the next sequence that erases the rest of the line.
    std::string read() const {
        std::string text;
        char next = 0;
        while (!text.ends_with("\x1b[K") && ::read(terminal_.number(), &next, 1) == 1) text += next;
        return text;
    }

private:
    Descriptor terminal_, before_;
};

/// A short activity must not hide the long one that follows.
TEST(ProgressLine, IsDrawnWhenAnActivityBegins) {
    const ErrorTerminal terminal;
    cli::ProgressLine line(true);
    line.show("reading", 0);
    EXPECT_TRUE(has_text(terminal.read(), "reading ["));
    line.show("detecting", 0);
    line.clear();
    EXPECT_TRUE(has_text(terminal.read(), "detecting ["));
}

}  // namespace
}  // namespace octopair::test
