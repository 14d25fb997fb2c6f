#include "dapple/base/words.h"

#include <gtest/gtest.h>

namespace dapple {
namespace {

TEST(Words, StandInThePluralForAllNumbersButOne)
{
    EXPECT_EQ(counted(1, "pass"), "1 pass");
    EXPECT_EQ(counted(0, "pass"), "0 passes");
    EXPECT_EQ(counted(2, "shape"), "2 shapes");
    EXPECT_EQ(counted(1, "shape"), "1 shape");
    EXPECT_EQ(counted(3, "eye path"), "3 eye paths");
    EXPECT_EQ(plural(2, "box"), "boxes");
    EXPECT_EQ(plural(2, "patch"), "patches");
}

}  // namespace
}  // namespace dapple
