#include "common/refused_words.h"

#include <gtest/gtest.h>

namespace slewlab::common {
namespace {

// As CLI11 2 says it (CLI/Error.hpp).
TEST(RefusedWords, SayWhatWasFoundAndWhatWouldBeRight) {
  EXPECT_EQ(refused_words("slewlab schema", "KIND excludes --out"), "slewlab schema: found KIND beside --out, expected one of the two");
  EXPECT_EQ(refused_words("slewlab run", "--speed requires --realtime"), "slewlab run: found --speed without --realtime, expected both or neither");
  EXPECT_EQ(refused_words("slewlab completion", "The following argument was not expected: zsh"),
            "slewlab completion: found 'zsh', expected no word more; slewlab completion --help says what it takes");
  EXPECT_EQ(refused_words("slewlab run", "--out: 1 required TEXT missing"), "slewlab run: --out: found nothing behind it, expected a value");
  EXPECT_EQ(refused_words("slewlab new", "KIND is required"), "slewlab new: KIND is required; slewlab new --help says what it takes");
  EXPECT_EQ(refused_words("slewlab", "A subcommand is required"), "slewlab: a command is required; slewlab --help lists them");
  EXPECT_EQ(refused_words("slewlab run", "Could not convert: --realtime = maybe"),
            "slewlab run: --realtime: found 'maybe', expected a value of another kind; slewlab run --help says what it takes");
  EXPECT_EQ(refused_words("slewlab replay", "LOG: found 'nope', expected the name of a file or a folder that is there"),
            "slewlab replay: LOG: found 'nope', expected the name of a file or a folder that is there");
}

}  // namespace
}  // namespace slewlab::common
