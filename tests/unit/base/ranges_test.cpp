// Ranges: what keeps them, and what the error says is allowed. Bounds and multipliers are tested as settings_test.cpp
// and command_line_test.py meet them.
#include "dapple/base/ranges.h"

#include "support/error_of.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

TEST(Ranges, NumbersWithinThemAreRead)
{
    EXPECT_EQ(parse_number("--passes", "2k", "integer >= 1"), 2000.0);
    EXPECT_EQ(parse_number("--x", "-1e-3", ""), -1e-3);
    EXPECT_EQ(parse_number("--x", "4096", "integer 1 to 4096"), 4096.0);
}

TEST(Ranges, ErrorsSayWhatIsAllowed)
{
    EXPECT_EQ(error_of([] { parse_number("--passes", "1.5", "integer >= 1", " or auto"); }),
              "--passes takes a whole number of 1 or more or auto, not '1.5'");
    EXPECT_EQ(error_of([] { parse_number("--threads", "0", "integer 1 to 4096"); }),
              "--threads takes a whole number from 1 to 4096, not '0'");
    EXPECT_EQ(error_of([] { parse_number("--x", "one", ""); }), "--x takes a number, not 'one'");
}

TEST(Ranges, WordsAreOfTheList)
{
    EXPECT_EQ(error_of([] { check_word("--color", "rgb", "spectral|rgb"); }), "");
    EXPECT_EQ(error_of([] { check_word("--color", "rbg", "spectral|rgb"); }),
              "--color takes spectral or rgb, not 'rbg'; did you mean 'rgb'?");
}

}  // namespace
}  // namespace dapple
