#include "msgs/configuration_hash.h"

#include <gtest/gtest.h>

namespace slewlab::msgs {
namespace {

// Values published with the algorithm by its authors (FNV test suite, fnv1a 64).
TEST(ConfigurationHash, AgreesWithThePublishedValues) {
  EXPECT_EQ(hash_text(configuration_hash("")), "cbf29ce484222325");
  EXPECT_EQ(hash_text(configuration_hash("a")), "af63dc4c8601ec8c");
  EXPECT_EQ(hash_text(configuration_hash("foobar")), "85944171f73967e8");
  EXPECT_EQ(hash_of_text("85944171f73967e8"), configuration_hash("foobar"));
  for (const char* wrong : {"", "85944171f73967e", "85944171F73967E8", "85944171f73967e8 "}) {
    EXPECT_THROW(hash_of_text(wrong), std::invalid_argument) << wrong;
  }
}

}  // namespace
}  // namespace slewlab::msgs
