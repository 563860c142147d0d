// Tests callbacks that call the engine of worker processes.
#include "support/reentry.hpp"
#include "octopair/processes.hpp"

namespace octopair::test {
namespace {

TEST(ProcessReentry, IsRefused) { expect_reentry_is_refused(*make_process_engine(2)); }

}  // namespace
}  // namespace octopair::test
