#include "tests/tools/verification/rows_are_reached.h"

namespace slewlab::tools {
namespace {

class PlantRows : public testing::TestWithParam<VerificationSection> {};

TEST_P(PlantRows, RowsAreReached) { expect_rows_reached(GetParam()); }

INSTANTIATE_TEST_SUITE_P(Thesis, PlantRows, testing::ValuesIn(sections_that_need_a_controller(false)),
                         [](const auto& test) { return test.param.id; });

}  // namespace
}  // namespace slewlab::tools
