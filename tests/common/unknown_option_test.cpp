#include "common/unknown_option.h"

#include <gtest/gtest.h>

namespace slewlab::common {
namespace {

TEST(UnknownOption, IsToldWithTheNearOne) {
  const std::vector<std::string> known{"--help", "--config", "--set"};
  EXPECT_EQ(unknown_option("plant", {"plant", "--config=a", "--ste", "a=1"}, known), "plant: '--ste' is no option of it, expected '--set' (or one of --help, --config, --set)");
  EXPECT_EQ(unknown_option("plant", {"plant", "--set", "a=1", "-3", "--", "--ste"}, known), std::nullopt);
}

}  // namespace
}  // namespace slewlab::common
