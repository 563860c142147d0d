// Tests callbacks of the remote engine that call their engine.
#include "support/reentry.hpp"
#include "service/served.hpp"

namespace octopair::test {
namespace {

TEST(RemoteReentry, IsRefused) {
    const Served served;
    expect_reentry_is_refused(*served.client());
}

}  // namespace
}  // namespace octopair::test
