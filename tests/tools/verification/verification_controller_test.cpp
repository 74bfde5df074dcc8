#include "tests/tools/verification/rows_are_reached.h"

namespace slewlab::tools {
namespace {

class ControllerRows : public testing::TestWithParam<VerificationSection> {};

TEST_P(ControllerRows, RowsAreReached) { expect_rows_reached(GetParam()); }

INSTANTIATE_TEST_SUITE_P(Thesis, ControllerRows, testing::ValuesIn(sections_that_need_a_controller(true)),
                         [](const auto& test) { return test.param.id; });

}  // namespace
}  // namespace slewlab::tools
