// Tests callbacks that call the engine of worker processes, and the places of its errors.
#include "support/reentry.hpp"
#include "octopair/processes.hpp"

namespace octopair::test {
namespace {

TEST(ProcessReentry, IsRefused) { expect_reentry_is_refused(*make_process_engine(2)); }

TEST(ProcessErrorPlaces, AreIndexAndSet) { expect_places_of_errors(*make_process_engine(2)); }

}  // namespace
}  // namespace octopair::test
